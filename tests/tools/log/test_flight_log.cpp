// SPDX-License-Identifier: BSD-3-Clause
// The flight log as a file: every bit of a number, every record or word of the missing ones.
#include "tools/log/flight_log.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <limits>
#include <sstream>
#include <thread>

#include "planner/base/version.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/log/log_reader.hpp"

namespace jink::tools::log {
namespace {

std::vector<Json> records(const std::string& text) {
  std::vector<Json> list;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) list.push_back(Json::parse(line));
  return list;
}

TEST(JsonWriter, NumbersReadBackToTheSameBits) {
  for (const double x : {0.0, -0.0, 1.0, -3.0, 0.1, 1.0 / 3.0, 1e22, -1e300, 123456789012345680.0,
                         18446744073709551615.0, 5e-324, std::numeric_limits<double>::max(), 2.2250738585072014e-308}) {
    base::JsonWriter line;
    line.open('[').number(x).close(']');
    const double again = Json::parse(line.str())[0].get<double>();
    EXPECT_EQ(std::bit_cast<std::uint64_t>(again), std::bit_cast<std::uint64_t>(x)) << line.str();
  }
}

TEST(JsonWriter, SaysWhatIsNotFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  base::JsonWriter line;
  line.open('[').number(inf).number(nan).exact(inf).exact(-inf).exact(nan).exact(2.5).close(']');
  EXPECT_EQ(line.str(), R"([null,null,"inf","-inf","nan",2.5])");
}

TEST(JsonWriter, SeparatesAndEscapes) {
  base::JsonWriter line;
  line.open('{').key("a").open('[').close(']').key("b").text("say \"{\n").key("c").flag(true);
  line.key("d").integer(18446744073709551615U).key("e").vector({1, 2, 3}).key("f").text("\xff").close('}');
  const Json json = Json::parse(line.str());
  EXPECT_EQ(json["a"], Json::array());
  EXPECT_EQ(json["b"], "say \"{\n");
  EXPECT_EQ(json["d"], 18446744073709551615U);
  EXPECT_EQ(json["e"], Json::array({1, 2, 3}));
  EXPECT_EQ(json["f"], "\xEF\xBF\xBD");
}

TEST(FlightLog, WritesEveryRecordInOrderAndAllBeforeItCloses) {
  const support::Folder folder;
  const auto file = folder.path() / "flight.jsonl";
  FlightLog log(file, {{"scenario", "s"}, {"seed", 7}});
  bridge::vehicle::VehicleState state;
  state.motion.value.position = {1.5, -0.0, 1e-9};
  state.armed = true;
  for (int i = 0; i < 500; ++i) {
    log.on_state(0.1 * i, state);
    log.on_event(0.1 * i, "name", std::to_string(i));
  }
  log.close();
  const auto list = records(support::read(file));
  ASSERT_EQ(list.size(), 1001U);
  EXPECT_EQ(list[0]["format"], "jink-log/1");
  EXPECT_EQ(list[0]["version"], JINK_VERSION);
  EXPECT_EQ(list[0]["seed"], 7);
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_EQ(list[2 * i + 1]["t"], 0.1 * static_cast<double>(i));
    EXPECT_EQ(list[2 * i + 2]["detail"], std::to_string(i));
  }
  EXPECT_EQ(list[1]["p"][2], 1e-9);
  EXPECT_EQ(list[1]["armed"], true);
  EXPECT_EQ(log.dropped(), 0U);
}

TEST(FlightLog, WritesWhatIsQueuedWhereNobodyClosesIt) {
  const support::Folder folder;
  const auto file = folder.path() / "flight.jsonl";
  {
    FlightLog log(file, {{"scenario", "s"}});
    for (int i = 0; i < 100; ++i) log.on_event(i, "e", "");
  }
  EXPECT_EQ(records(support::read(file)).size(), 101U);
}

/// A pipe as the log's file: as long as nobody reads it, it is a disk that does not take anything.
class Pipe {
 public:
  explicit Pipe(const std::filesystem::path& file) {
    EXPECT_EQ(::mkfifo(file.c_str(), 0600), 0);
    descriptor_ = ::open(file.c_str(), O_RDONLY | O_NONBLOCK);  // NOLINT: the system's interface
    EXPECT_EQ(::fcntl(descriptor_, F_SETFL, 0), 0);             // NOLINT
  }
  ~Pipe() { ::close(descriptor_); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  /// All up to the end of the writer.
  std::string drain() const {
    std::string text;
    std::array<char, 65536> piece{};
    for (ssize_t n = 0; (n = ::read(descriptor_, piece.data(), piece.size())) > 0;)
      text.append(piece.data(), static_cast<std::size_t>(n));
    return text;
  }

 private:
  int descriptor_ = -1;
};

TEST(FlightLog, DropsWhatASlowDiskDoesNotTakeAndSaysSo) {
  const support::Folder folder;
  const auto file = folder.path() / "pipe.jsonl";
  const Pipe pipe(file);
  std::uint64_t dropped = 0;
  std::string text;
  std::thread reader;
  {
    FlightLog log(file, {{"scenario", "s"}}, {.wait = false, .queue_bytes = 100000});
    const std::string detail(1000, 'x');
    int put = 0;
    while (log.dropped() < 3) log.on_event(put++, "e", detail);
    dropped = log.dropped();
    EXPECT_LT(put, 1000);
    ::testing::internal::CaptureStderr();
    reader = std::thread([&] { text = pipe.drain(); });
    log.close();
    EXPECT_NE(::testing::internal::GetCapturedStderr().find("pipe.jsonl: 3 records were left out"), std::string::npos);
  }
  reader.join();
  const auto list = records(text);
  EXPECT_EQ(dropped, 3U);
  EXPECT_EQ(list.back()["name"], "log_dropped");
  EXPECT_TRUE(list.back()["detail"].get<std::string>().starts_with("3 records are missing here"));
  EXPECT_EQ(list[list.size() - 2]["name"], "e");
}

TEST(FlightLog, WaitsForASlowDiskInVirtualTime) {
  const support::Folder folder;
  const auto file = folder.path() / "pipe.jsonl";
  const Pipe pipe(file);
  std::string text;
  std::thread reader;
  {
    FlightLog log(file, {{"scenario", "s"}}, {.wait = true, .queue_bytes = 5000});
    reader = std::thread([&] { text = pipe.drain(); });
    for (int i = 0; i < 2000; ++i) log.on_event(i, "e", std::string(1000, 'x'));
    log.close();
    EXPECT_EQ(log.dropped(), 0U);
  }
  reader.join();
  EXPECT_EQ(records(text).size(), 2001U);
}

TEST(FlightLog, ComplainsOfAFullDiskWhenItCloses) {
  FlightLog log("/dev/full", {{"scenario", "s"}});
  for (int i = 0; i < 100; ++i) log.on_event(i, "e", "");
  EXPECT_THROW(log.close(), std::runtime_error);
}

TEST(FlightLog, RefusesAFileThatCannotBeWritten) {
  EXPECT_THROW(FlightLog("/no/such/folder/x.jsonl", {}), cli::UsageError);
}

}  // namespace
}  // namespace jink::tools::log
