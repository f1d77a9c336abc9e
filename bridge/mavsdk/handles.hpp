// SPDX-License-Identifier: BSD-3-Clause
// Owners for the handles of MAVSDK's C interface, and its log. For mavsdk_link.cpp alone.
#pragma once

#include <memory>
#include <string>
#include <type_traits>

#include "bridge/mavsdk/c_api.h"

namespace jink::bridge::mavsdk {

template <typename Handle, void (*destroy)(Handle)>
struct MavsdkDestroy {
  using pointer = Handle;
  void operator()(Handle handle) const { destroy(handle); }
};
template <typename Handle, void (*destroy)(Handle)>
using MavsdkUnique = std::unique_ptr<std::remove_pointer_t<Handle>, MavsdkDestroy<Handle, destroy>>;

// MAVSDK aborts when these go in another order than plugin, system, MAVSDK: declare them in the reverse one.
using ConfigurationHandle = MavsdkUnique<mavsdk_configuration_t, mavsdk_configuration_destroy>;
using MavsdkHandle = MavsdkUnique<mavsdk_t, mavsdk_destroy>;
using SystemHandle = MavsdkUnique<mavsdk_system_t, mavsdk_system_destroy>;
using DirectHandle = MavsdkUnique<mavsdk_mavlink_direct_t, mavsdk_mavlink_direct_destroy>;

/// Takes MAVSDK's log off the terminal and keeps its newest warning or error; once per process, as MAVSDK has one log.
/// These three are safe from any thread.
void capture_mavsdk_log();
[[nodiscard]] std::string mavsdk_last_warning();
/// The same, and forgets it.
[[nodiscard]] std::string take_mavsdk_warning();

}  // namespace jink::bridge::mavsdk
