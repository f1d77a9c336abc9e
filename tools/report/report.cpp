// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/report.hpp"

#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "tools/report/flight_data.hpp"
#include "tools/report/report_data.hpp"
#include "tools/report/template.hpp"

namespace jink::tools {
namespace {

constexpr std::string_view kDataPlace = "{{data}}";

/// JSON that can stand in an HTML script element: no character that could end the element or open a comment or an
/// entity, and no "//", so that no address of a log makes the page look as if it fetched something. All of these only
/// occur within JSON strings.
std::string embeddable(const std::string& json) {
  std::string out;
  out.reserve(json.size() + json.size() / 64);
  for (const char c : json) {
    switch (c) {
      case '<':
        out += "\\u003c";
        break;
      case '>':
        out += "\\u003e";
        break;
      case '&':
        out += "\\u0026";
        break;
      case '/':
        out += "\\/";
        break;
      default:
        out += c;
    }
  }
  return out;
}

void write_whole(const std::filesystem::path& file, std::string_view text) {
  const std::filesystem::path part = file.string() + "." + std::to_string(::getpid()) + ".part";
  const auto fail = [&](const std::string& what) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw std::runtime_error(file.string() + ": " + what);
  };
  std::ofstream out(part, std::ios::binary);
  if (!out) fail("cannot write the flight report");
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) fail("the flight report could not be written to its end");
  std::error_code error;
  std::filesystem::rename(part, file, error);
  if (error) fail("cannot write the flight report: " + error.message());
}

}  // namespace

ReportResult write_report(const std::filesystem::path& log, const std::filesystem::path& html,
                          const nlohmann::json* summary) {
  const FlightData flight = read_flight(log);
  nlohmann::json data = report_data(flight, summary);
  data["file"] = log.filename().string();
  const std::string_view page = report_template();
  const std::size_t place = page.find(kDataPlace);
  if (place == std::string_view::npos) throw std::logic_error("template.html has no {{data}}");
  std::string text(page.substr(0, place));
  text += embeddable(data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  text += page.substr(place + kDataPlace.size());
  write_whole(html, text);
  return {flight.lines, flight.cut_off + flight.not_finite + flight.unknown};
}

}  // namespace jink::tools
