// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/mavsdk/handles.hpp"

#include <mutex>
#include <utility>

namespace jink::bridge::mavsdk {

namespace {

struct LogStore {
  std::mutex mutex;  // guards last_warning
  std::string last_warning;
};

// MAVSDK's subscription is one per process, so what it fills is too. Never destroyed: MAVSDK may log until the end.
LogStore& log_store() {
  static LogStore& store = *new LogStore;
  return store;
}

bool on_log(int level, const char* message, const char* /*file*/, int /*line*/, void* /*user_data*/) {
  if (level >= MAVSDK_LOG_LEVEL_WARN && message != nullptr) {
    LogStore& store = log_store();
    const std::scoped_lock lock(store.mutex);
    store.last_warning = message;
  }
  return true;  // dealt with: not printed
}

}  // namespace

void capture_mavsdk_log() {
  static std::once_flag once;
  std::call_once(once, [] { mavsdk_log_subscribe(on_log, nullptr); });
}

std::string mavsdk_last_warning() {
  LogStore& store = log_store();
  const std::scoped_lock lock(store.mutex);
  return store.last_warning;
}

std::string take_mavsdk_warning() {
  LogStore& store = log_store();
  const std::scoped_lock lock(store.mutex);
  return std::exchange(store.last_warning, {});
}

}  // namespace jink::bridge::mavsdk
