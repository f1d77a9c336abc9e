// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/html_report.hpp"

#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "tools/base/atomic_file.hpp"
#include "tools/report/flight_data.hpp"
#include "tools/report/report_data.hpp"
#include "tools/report/template.hpp"

namespace jink::tools::report {
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

}  // namespace

void write_atomically(const std::filesystem::path& file, std::string_view bytes, const std::string& what) {
  if (const std::error_code error = base::write_file(file, bytes))
    throw std::runtime_error(file.string() + ": cannot write " + what + ": " + error.message());
}

std::vector<ReportResult> write_report(std::span<const ReportSource> sources, const std::filesystem::path& html) {
  nlohmann::json data;
  data["flights"] = nlohmann::json::array();
  std::vector<ReportResult> results;
  for (const ReportSource& source : sources) {
    const FlightData flight = read_flight(source.log);
    data["flights"].push_back(report_data(flight, source.summary ? &*source.summary : nullptr));
    data["flights"].back()["file"] = source.log.filename().string();
    results.push_back({flight.lines, flight.cut_off + flight.not_finite + flight.unknown});
  }
  const std::string_view page = report_template();
  const std::size_t place = page.find(kDataPlace);
  if (place == std::string_view::npos) throw std::logic_error("template.html has no {{data}}");
  std::string text(page.substr(0, place));
  text += embeddable(data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  text += page.substr(place + kDataPlace.size());
  write_atomically(html, text, "the flight report");
  return results;
}

ReportResult write_report(const std::filesystem::path& log, const std::filesystem::path& html,
                          const nlohmann::json* summary) {
  const ReportSource source{log, summary != nullptr ? std::optional(*summary) : std::nullopt};
  return write_report(std::span(&source, 1), html).front();
}

}  // namespace jink::tools::report
