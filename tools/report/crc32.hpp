// SPDX-License-Identifier: BSD-3-Clause
// The checksum of zip, PNG and MCAP.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace jink::tools::report {

/// CRC-32 (ISO-HDLC: reflected 0x04C11DB7, all ones in and out), continued from `crc`; 0 to begin.
[[nodiscard]] constexpr std::uint32_t crc32(std::string_view bytes, std::uint32_t crc = 0) {
  constexpr auto kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
      table[i] = c;
    }
    return table;
  }();
  crc = ~crc;
  for (const char c : bytes) crc = kTable[(crc ^ static_cast<std::uint8_t>(c)) & 0xFFU] ^ (crc >> 8U);
  return ~crc;
}

}  // namespace jink::tools::report
