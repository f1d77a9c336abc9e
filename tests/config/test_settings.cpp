// SPDX-License-Identifier: BSD-3-Clause
#include "config/settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "config/text.hpp"
#include "tests/config/yaml_case.hpp"

namespace jink::config {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(JINK_SOURCE_DIR) / "config" / "planner.yaml";

std::string shipped_text() {
  std::ostringstream out;
  out << std::ifstream(kShipped).rdbuf();
  return out.str();
}

int line_of(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

std::string set_error(const std::vector<std::string>& overrides) {
  std::string error = error_of([&] { static_cast<void>(load_settings(kShipped, overrides)); });
  EXPECT_EQ(error.find('\n'), std::string::npos);
  return error;
}

/// Stands for a field of any type in the aggregate initialisation below.
struct AnyField {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): the conversion is what it is for; never defined
};

/// How many members an aggregate has: the most initialisers that it takes.
template <class T, class... Fields>
constexpr std::size_t field_count() {
  if constexpr (requires { T{Fields{}..., AnyField{}}; }) {
    return field_count<T, Fields..., AnyField>();
  } else {
    return sizeof...(Fields);
  }
}

TEST(LoadSettings, ShippedFileHoldsTheDefaults) {
  const std::vector<SettingText> file = list_settings(load_settings(kShipped));
  const std::vector<SettingText> defaults = list_settings(Settings{});
  ASSERT_EQ(file.size(), defaults.size());
  for (std::size_t i = 0; i < file.size(); ++i) {
    EXPECT_EQ(file[i].key, defaults[i].key);
    EXPECT_EQ(file[i].value, defaults[i].value) << file[i].key;
  }
}

// A field that is added to a struct but not to the loader's table would silently keep its default.
TEST(LoadSettings, TableHoldsEveryFieldOfEverySection) {
  const std::vector<SettingText> all = list_settings(Settings{});
  const auto count = [&](const std::string& section) {
    return static_cast<std::size_t>(std::count_if(
        all.begin(), all.end(), [&](const SettingText& setting) { return setting.key.starts_with(section + "."); }));
  };
  EXPECT_EQ(count("optimizer"), field_count<planner::base::OptimizerSettings>());
  EXPECT_EQ(count("paper"), field_count<planner::base::PaperSettings>());
  EXPECT_EQ(count("horizon"), field_count<planner::base::HorizonSettings>());
  EXPECT_EQ(count("companion"), field_count<CompanionSettings>());
  EXPECT_EQ(field_count<Settings>(), 4U);
}

// Each key set to a value of its own must change itself and nothing else: no two lines of the table share a member.
TEST(LoadSettings, EachOverrideChangesItsKeyAlone) {
  const std::vector<SettingText> defaults = list_settings(Settings{});
  for (const SettingText& setting : defaults) {
    std::string value;
    if (setting.key == "paper.constraint") {
      value = "paper";
    } else if (setting.key == "paper.axis") {
      value = "path";
    } else if (setting.key == "optimizer.operators") {
      value = "printed";
    } else if (setting.value == "true" || setting.value == "false") {
      value = setting.value == "true" ? "false" : "true";
    } else if (setting.value.find('.') == std::string::npos && std::stod(setting.value) >= 2) {
      value = number_text(std::stod(setting.value) + 1);
    } else {
      value = number_text(std::stod(setting.value) * 0.875);  // within every range, and exact
    }
    const std::vector<SettingText> changed = list_settings(load_settings(kShipped, {setting.key + "=" + value}));
    ASSERT_EQ(changed.size(), defaults.size());
    for (std::size_t i = 0; i < changed.size(); ++i) {
      EXPECT_EQ(changed[i].value, changed[i].key == setting.key ? value : defaults[i].value)
          << changed[i].key << " after --set " << setting.key << "=" << value;
    }
  }
}

TEST(LoadSettings, AppliesOverridesInOrder) {
  const Settings s = load_settings(kShipped, {"paper.margin=0.2", "paper.constraint=paper", "paper.margin=2e-1",
                                              "horizon.slaves=96", "horizon.population=960", "paper.margin=0.25"});
  EXPECT_EQ(s.paper.margin, 0.25);
  EXPECT_EQ(s.paper.constraint, planner::base::Constraint::kPaper);
  EXPECT_EQ(s.horizon.slaves, 96);  // more than the file's population: only the end result counts
  EXPECT_EQ(s.horizon.population, 960);
}

TEST(LoadSettings, RefusesBadOverrides) {
  struct Case {
    std::string text;
    std::string expected;
  };
  const std::vector<Case> cases = {
      {"paper.margin=x", "value 'x' is a string; expected a number in [0, 100]"},
      {"paper.margin=", "value '' is empty; expected a number"},
      {"paper.margin=-1", "value '-1' is not in [0, 100]"},
      {"paper.margin=nan", "value 'nan' is not a finite number"},
      {"paper.margin=1e999", "value '1e999' is not a finite number"},
      {"paper.margin=true", "value 'true' is a boolean"},
      {"paper.margin= 1", "value ' 1' is a string"},
      {"paper.margin=[1]", "value '[1]' is a string"},
      {"optimizer.slaves=0", "value '0' is not in [1, 256]"},
      {"optimizer.slaves=2.5", "value '2.5' is not an integer; expected an integer in [1, 256]"},
      {"paper.constraint=sweept", "is not one of paper, swept; did you mean 'swept'?"},
      {"paper.margn=1", "key 'paper.margn': unknown key with value '1'; did you mean 'paper.margin'?"},
      {"xyz=1", "key 'xyz': unknown key with value '1'; allowed: optimizer.slaves"},
      {"=1", "key '': unknown key with value '1'"},
      {"paper.margin", "has no '='; expected section.key=value"},
      {"", "has no '='"},
      {"optimizer.slaves=51", "key 'optimizer.population': value '50' is smaller than the number of slaves"},
      {"optimizer.wep_max=0.1", "key 'optimizer.wep_min': value '0.2' is above wep_max; not in [0, 0.1]"},
      {"horizon.slaves=25",
       "key 'horizon.population': value '24' is smaller than the number of slaves; not in [25, 100000]"},
      {"horizon.step=7", "value '7' is above time; not in [0.001, 6]"},
  };
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.text);
    const std::string error = set_error({bad.text});
    EXPECT_TRUE(error.starts_with("--set " + bad.text + ": ")) << error;
    expect_contains(error, bad.expected);
  }
}

TEST(LoadSettings, NamesTheOverridesThatDoNotGoTogether) {
  const std::string error = set_error(
      {"paper.margin=1", "horizon.weight_length=0", "horizon.weight_steering=0", "horizon.weight_clearance=0"});
  EXPECT_EQ(error,
            "--set horizon.weight_length=0 --set horizon.weight_steering=0 --set horizon.weight_clearance=0: key "
            "'horizon.weight_length': value '0' and the other weights are all 0; expected one that is above 0");
}

TEST(LoadSettings, RefusesBadFiles) {
  const std::string valid = shipped_text();
  const std::vector<BadCase> cases = {
      {"jink-planner/1", "jink-planner/9", 0, "format", "jink-planner/9", "is not 'jink-planner/1'"},
      {"archive: 100 ", "archive: many ", 0, "optimizer.archive", "many", "expected an integer in [2, 100000]"},
      {"wep_min: 0.2", "wep_min: 1.5", 0, "optimizer.wep_min", "1.5", "is not in [0, 1]"},
      {"wep_max: 1.0", "wep_max: 0.1", -1, "optimizer.wep_min", "0.2", "is above wep_max; not in [0, 0.1]"},
      {"population: 50", "population: 5", 0, "optimizer.population", "5", "smaller than the number of slaves"},
      {"steering_limit_deg: 60.0", "steering_limit_deg: 181", 0, "paper.steering_limit_deg", "181", "(0, 180]"},
      {"constraint: swept", "constraint: both", 0, "paper.constraint", "both", "is not one of paper, swept"},
      {"opposition:", "oppositon:", 0, "optimizer.oppositon", "false", "did you mean 'opposition'?"},
      {"opposition: false", "opposition: no", 0, "optimizer.opposition", "no", "is not one of false, true"},
      {"keep_ratio: 0.05", "keep_ratio: 1", 0, "horizon.keep_ratio", "1", "is not in [0, 1)"},
      {"stale_plan: 0.3", "stale_plan: .nan", 0, "companion.stale_plan", ".nan", "not a finite number"},
      {"companion:\n", "companions:\n", 0, "companions", "", "did you mean 'companion'?"},
      {"horizon:\n", "horizon: []\nignored:\n", 1, "ignored", "", "unknown key"},
  };
  for (BadCase bad : cases) {
    // The shipped file's lines move with its comments: the line is where the change is, plus the case's offset.
    bad.line += line_of(valid, bad.from);
    expect_refused(valid, bad, [](const std::filesystem::path& file) { static_cast<void>(load_settings(file)); });
  }
}

TEST(LoadSettings, RequiresEveryKey) {
  const std::string valid = shipped_text();
  std::istringstream lines(valid);
  std::string section;
  int removed = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
    if (line[0] != ' ') {
      section = line.substr(0, colon);
      continue;
    }
    const std::string key = section + "." + line.substr(2, colon - 2);
    std::string text = valid;
    // The key's own section, as some names occur in two.
    const std::size_t begin = text.find("\n" + section + ":");
    text.erase(text.find(line + "\n", begin), line.size() + 1);
    const Folder folder;
    const auto file = folder.write("p.yaml", text);
    expect_contains(error_of([&] { static_cast<void>(load_settings(file)); }),
                    ": key '" + key + "': missing; expected ");
    ++removed;
  }
  EXPECT_EQ(static_cast<std::size_t>(removed), list_settings(Settings{}).size());
}

TEST(LoadSettings, SaysWhereAnUpgradeLeftTheNewFile) {
  const std::string valid = shipped_text();
  const std::string line = "  keep_ratio: 0.05";
  std::string old = valid;
  old.erase(old.find(line), old.find('\n', old.find(line)) + 1 - old.find(line));
  const Folder folder;
  const auto file = folder.write("planner.yaml", old);
  const auto load = [&] { static_cast<void>(load_settings(file)); };
  EXPECT_EQ(error_of(load).find("dpkg"), std::string::npos);
  const auto newer = folder.write("planner.yaml.dpkg-dist", valid);
  expect_contains(error_of(load), "key 'horizon.keep_ratio': missing; expected ");
  EXPECT_TRUE(error_of(load).ends_with("; this version's own file is " + newer.string())) << error_of(load);
}

TEST(NumberText, ReadsBackToTheSameBits) {
  for (const double value : {0.0, 0.1, 1.0 / 3.0, 1e-300, 123456789.125, 1e22, -5.0, 20.0, 1e5}) {
    EXPECT_EQ(parse_number(number_text(value)), value);
  }
  EXPECT_EQ(number_text(100000), "100000");
  EXPECT_EQ(number_text(0.35), "0.35");
}

TEST(Nearest, KnowsTyposAndLeavesTheRest) {
  const std::vector<std::string_view> names = {"rate", "range", "delay"};
  EXPECT_EQ(nearest("rat", names), "rate");
  EXPECT_EQ(nearest("arte", names), "rate");
  EXPECT_EQ(nearest("RANGE", names), "range");
  EXPECT_EQ(nearest("dleay", names), "delay");
  EXPECT_EQ(nearest("colour", names), "");
  EXPECT_EQ(nearest(std::string(1000, 'x'), names), "");
}

TEST(Settings, WithoutAFileAreTheShippedOnes) {
  EXPECT_EQ(list_settings(load_settings({})), list_settings(load_settings(config_folder() / "planner.yaml")));
}

TEST(ConfigFolder, IsWhereAProcessThatIsNotJinksWasTold) {
  const std::filesystem::path shipped = config_folder();
  set_config_folder("/elsewhere");
  EXPECT_EQ(config_folder(), "/elsewhere");
  ASSERT_EQ(setenv("JINK_CONFIG_DIR", "/first", 1), 0);  // NOLINT(concurrency-mt-unsafe)
  EXPECT_EQ(config_folder(), "/first");
  ASSERT_EQ(unsetenv("JINK_CONFIG_DIR"), 0);  // NOLINT(concurrency-mt-unsafe)
  set_config_folder({});
  EXPECT_EQ(config_folder(), shipped);
}

}  // namespace
}  // namespace jink::config
