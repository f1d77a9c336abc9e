// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/pilot_texts.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using jink::bridge::companion::PilotTexts;
using jink::bridge::vehicle::Severity;

std::vector<std::string> take(PilotTexts& texts, double now) {
  std::vector<std::string> taken;
  while (const auto text = texts.next(now)) taken.push_back(text->text);
  return taken;
}

using Lines = std::vector<std::string>;

TEST(PilotTexts, SayPhasesHazardsAndEndings) {
  struct Case {
    const char* event;
    const char* detail;
    const char* text;
    Severity severity;
  };
  for (const Case& c :
       {Case{"phase", "engaging", "jink: taking over", Severity::kInfo},
        Case{"phase", "flying", "jink: flying", Severity::kInfo},
        Case{"phase", "handover", "jink: handing over to HOLD", Severity::kInfo},
        Case{"phase", "done: reached, target reached", "jink: done: reached, target reached", Severity::kInfo},
        Case{"phase", "done: aborted, interrupted", "jink: done: aborted, interrupted", Severity::kCritical},
        Case{"hazard", "the obstacle tracks are stale", "jink: braking: the obstacle tracks are stale",
             Severity::kWarning},
        Case{"hazard", "the autopilot's failsafe flies, mode position",
             "jink: braking: the autopilot's failsafe flies, mode position", Severity::kCritical},
        Case{"hazard_over", "", "jink: hazard over", Severity::kInfo},
        Case{"battery", "low", "jink: battery low", Severity::kWarning},
        Case{"refused", "arm: temporarily rejected", "jink: refused: arm: temporarily rejected", Severity::kWarning}}) {
    PilotTexts texts;
    texts.on_event(1.0, c.event, c.detail);
    const auto text = texts.next(1.0);
    ASSERT_TRUE(text) << c.text;
    EXPECT_EQ(text->text, c.text);
    EXPECT_EQ(text->severity, c.severity) << c.text;
    EXPECT_FALSE(texts.next(1.0));
  }
  PilotTexts texts;
  texts.on_event(1.0, "battery", "ok");
  texts.on_event(1.0, "plan_status", "blocked");
  texts.on_event(1.0, "waiting", "an autopilot's heartbeat on udpin://127.0.0.1:14540");
  texts.on_event(1.0, "autopilot_text", "warning: never back to where it came from");
  EXPECT_FALSE(texts.next(1.0));
}

TEST(PilotTexts, AreTwoASecondWithTheNewestPhaseFirst) {
  PilotTexts texts;
  for (const char* what : {"a", "b", "c"}) texts.on_event(0.0, "hazard", what);
  texts.on_event(0.0, "phase", "climbing");
  texts.on_event(0.0, "phase", "flying");
  EXPECT_EQ(take(texts, 0.0), (Lines{"jink: flying", "jink: braking: a"}));
  texts.on_event(0.5, "phase", "stopping");
  EXPECT_EQ(take(texts, 0.9), Lines{});
  EXPECT_EQ(take(texts, 1.0), (Lines{"jink: stopping", "jink: braking: b"}));
  EXPECT_EQ(take(texts, 2.5), (Lines{"jink: braking: c"}));
}

TEST(PilotTexts, DoNotRepeatThemselvesWithinFiveSeconds) {
  PilotTexts texts;
  texts.on_event(0.0, "hazard", "a");
  EXPECT_EQ(take(texts, 0.0), Lines{"jink: braking: a"});
  texts.on_event(3.0, "hazard", "a");
  texts.on_event(3.0, "hazard", "b");
  EXPECT_EQ(take(texts, 3.0), Lines{"jink: braking: b"});
  EXPECT_EQ(take(texts, 5.0), Lines{});  // what was said already is not kept
  texts.on_event(5.0, "hazard", "a");
  EXPECT_EQ(take(texts, 5.0), Lines{"jink: braking: a"});
}

TEST(PilotTexts, LoseNoPhaseThatComesBack) {
  PilotTexts texts;
  for (const char* phase : {"waiting", "engaging", "waiting"}) {
    texts.on_event(0.0, "phase", phase);
    (void)take(texts, 0.0);
  }
  EXPECT_EQ(take(texts, 4.9), Lines{});
  EXPECT_EQ(take(texts, 5.0), Lines{"jink: waiting"});
}

TEST(PilotTexts, TellTheEndWhateverTheRate) {
  PilotTexts texts;
  for (const char* what : {"a", "b"}) texts.on_event(0.0, "hazard", what);
  EXPECT_EQ(take(texts, 0.0).size(), 2U);
  texts.on_event(0.1, "phase", "done: aborted, interrupted");
  EXPECT_FALSE(texts.next(0.1));
  EXPECT_EQ(texts.last()->text, "jink: done: aborted, interrupted");
  EXPECT_FALSE(texts.last());
}

TEST(PilotTexts, ForgetTheOldestOfTooMany) {
  PilotTexts texts;
  for (int i = 0; i < 100; ++i) texts.on_event(0.0, "hazard", std::to_string(i));
  Lines all;
  for (int second = 0; second < 20; ++second) {
    for (const std::string& text : take(texts, second)) all.push_back(text);
  }
  ASSERT_EQ(all.size(), PilotTexts::kWaiting);
  EXPECT_EQ(all.back(), "jink: braking: 99");
}

}  // namespace
