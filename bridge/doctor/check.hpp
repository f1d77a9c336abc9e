// SPDX-License-Identifier: BSD-3-Clause
// One finding of `jink doctor`: what was looked at, what was seen, what to do about it.
#pragma once

#include <string>

namespace jink::bridge::doctor {

struct Check {
  enum class Level {
    kOk,
    kWarning,  ///< a flight is possible; something will hurt when things go wrong
    kFault,    ///< not ready to fly
    kMissing,  ///< somebody who is needed is not there
  };
  Level level = Level::kOk;
  std::string name;     ///< "heartbeat", "COM_OBL_RC_ACT", "rt/jink/obstacle_tracks"
  std::string finding;  ///< measured or read, with units; one line
  std::string remedy;   ///< what to try or set; empty where all is well; one line
};

}  // namespace jink::bridge::doctor
