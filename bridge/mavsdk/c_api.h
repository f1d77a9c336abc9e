/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The part of MAVSDK 4.1.0's C interface that jink uses: the wheel that carries libcmavsdk.so has no headers. Written
 * from the wheel's ctypes declarations (mavsdk/mavsdk.py, system.py, logging.py, types.py and
 * plugins/mavlink_direct/mavlink_direct.py), which tools/requirements.txt pins. Enums travel as int.
 *
 * Ownership, learnt from the same files and by trial:
 * - each handle from a _create, first_autopilot or get_systems has one _destroy of its own;
 * - order: unsubscribe, destroy plugins, destroy systems, mavsdk_destroy; any other order aborts the process;
 * - unsubscribing waits for a running callback, so it must not be done under a lock that the callback takes;
 * - a message given to a callback is the callback's to free, with mavsdk_mavlink_direct_mavlink_message_destroy;
 * - callbacks come from MAVSDK's own thread and must not throw;
 * - mavlink_direct hears every component of its system, and no other system; also while MAVSDK holds the system for
 *   timed out (3 s without a heartbeat), when sending goes on too. A UDP peer that was silent for 10 s is sent nothing
 *   until it speaks again;
 * - a float that is not finite comes as null in the JSON fields, and goes so.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mavsdk_opaque* mavsdk_t;
typedef struct mavsdk_configuration_opaque* mavsdk_configuration_t;
typedef struct mavsdk_system_opaque* mavsdk_system_t;
typedef struct mavsdk_mavlink_direct_opaque* mavsdk_mavlink_direct_t;
typedef struct mavsdk_subscription_opaque* mavsdk_subscription_t;

enum { MAVSDK_COMPONENT_TYPE_COMPANION_COMPUTER = 2 };
enum { MAVSDK_CONNECTION_RESULT_SUCCESS = 0, MAVSDK_CONNECTION_RESULT_URL_INVALID = 12 };
enum { MAVSDK_MAVLINK_DIRECT_RESULT_SUCCESS = 1 };
enum { MAVSDK_LOG_LEVEL_WARN = 2 };

/* A MAVLink message by name, its fields as a JSON object. The target_ members are filled on reception; on sending the
 * target is what the fields say where these are 0. */
typedef struct {
  const char* message_name;
  uint32_t system_id;
  uint32_t component_id;
  uint32_t target_system_id;
  uint32_t target_component_id;
  const char* fields_json;
} mavsdk_mavlink_message_t;

typedef void (*mavsdk_mavlink_message_callback_t)(mavsdk_mavlink_message_t message, void* user_data);
/* True: the line is dealt with and not printed. */
typedef bool (*mavsdk_log_callback_t)(int level, const char* message, const char* file, int line, void* user_data);

void mavsdk_log_subscribe(mavsdk_log_callback_t callback, void* user_data);

mavsdk_configuration_t mavsdk_configuration_create_with_component_type(int component_type);
void mavsdk_configuration_destroy(mavsdk_configuration_t configuration);
uint32_t mavsdk_configuration_get_system_id(mavsdk_configuration_t configuration);
void mavsdk_configuration_set_system_id(mavsdk_configuration_t configuration, uint32_t system_id);
void mavsdk_configuration_set_component_id(mavsdk_configuration_t configuration, uint8_t component_id);

mavsdk_t mavsdk_create(mavsdk_configuration_t configuration);
void mavsdk_destroy(mavsdk_t mavsdk);
/* Also while it runs: what goes out from then on, the heartbeat too, has these ids. */
void mavsdk_set_configuration(mavsdk_t mavsdk, mavsdk_configuration_t configuration);
int mavsdk_add_any_connection(mavsdk_t mavsdk, const char* connection_url);
/* Blocks for timeout_s at most; null when no autopilot was heard. */
mavsdk_system_t mavsdk_first_autopilot(mavsdk_t mavsdk, double timeout_s);
/* A handle for each system heard so far, each the caller's to destroy, in an array of its own, freed below. */
mavsdk_system_t* mavsdk_get_systems(mavsdk_t mavsdk, size_t* count);
void mavsdk_free_systems_array(mavsdk_system_t* systems);

uint32_t mavsdk_system_get_system_id(mavsdk_system_t system);
bool mavsdk_system_has_autopilot(mavsdk_system_t system);
void mavsdk_system_destroy(mavsdk_system_t system);

mavsdk_mavlink_direct_t mavsdk_mavlink_direct_create(mavsdk_system_t system);
void mavsdk_mavlink_direct_destroy(mavsdk_mavlink_direct_t plugin);
int mavsdk_mavlink_direct_send_message(mavsdk_mavlink_direct_t plugin, mavsdk_mavlink_message_t message);
mavsdk_subscription_t mavsdk_mavlink_direct_subscribe_message(mavsdk_mavlink_direct_t plugin, const char* message_name,
                                                              mavsdk_mavlink_message_callback_t callback,
                                                              void* user_data);
void mavsdk_mavlink_direct_unsubscribe_message(mavsdk_mavlink_direct_t plugin, mavsdk_subscription_t subscription);
void mavsdk_mavlink_direct_mavlink_message_destroy(mavsdk_mavlink_message_t* message);

#ifdef __cplusplus
}

/* Passed by value: a wrong size would corrupt the stack. 64-bit pointers, as both of the wheel's platforms have. */
static_assert(sizeof(mavsdk_mavlink_message_t) == 32, "mavsdk_mavlink_message_t differs from the library's");
#endif
