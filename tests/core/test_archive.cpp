#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/archive.hpp"
#include "core/error.hpp"

namespace brisance {
namespace {

struct Record {
  double time = 0.0;
  std::vector<int> list;
};

void archive(Archive& a, Record& r) { a(r.time, r.list); }

enum class Colour : int { red, green };

struct Everything {
  bool yes = false;
  int count = 0;
  long number = 0;
  double value = 0.0;
  Colour colour = Colour::red;
  std::string text;
  std::array<double, 3> vector{};
  std::vector<std::uint8_t> bytes;
  std::vector<std::vector<Record>> records;
  std::map<std::string, double> timings;

  void archive(Archive& a) { a(yes, count, number, value, colour, text, vector, bytes, records, timings); }
};

template <class T>
std::string written(T& value) {
  std::string out;
  Archive a([&](void const* bytes, std::size_t count) { out.append(static_cast<char const*>(bytes), count); });
  a(value);
  return out;
}

Archive reader(std::string const& from) {
  return {[&from, at = std::size_t{0}](void* bytes, std::size_t count) mutable {
            ASSERT_LE(at + count, from.size()) << "read beyond the end";
            std::memcpy(bytes, from.data() + at, count);
            at += count;
          },
          from.size()};
}

std::string problem(std::function<void()> const& action) {
  try {
    action();
  } catch (IoError const& error) {
    return error.what();
  }
  return "";
}

TEST(Archive, GivesBackEveryBit) {
  Everything before{true,
                    -7,
                    1L << 40,
                    -0.0,
                    Colour::green,
                    std::string("a\0b", 3),
                    {1e-320, std::nan(""), std::numeric_limits<double>::infinity()},
                    {0, 255},
                    {{}, {{0.1, {1, 2}}, {0.2, {}}}},
                    {{"sweeps", 1.5}, {"", 0.0}}};
  std::string const bytes = written(before);
  Everything after;
  after.records = {{{9.0, {9}}}};
  after.timings = {{"left over", 1.0}};
  Archive a = reader(bytes);
  a(after);
  EXPECT_NO_THROW(a.end());
  EXPECT_EQ(written(after), bytes);
  EXPECT_EQ(after.text.size(), 3U);
  EXPECT_TRUE(std::signbit(after.value));
  EXPECT_EQ(after.vector[0], 1e-320);
  EXPECT_EQ(after.records[1][0].list, (std::vector{1, 2}));
  EXPECT_EQ(after.timings.size(), 2U);
}

TEST(Archive, SizesThatTheReaderKnowsAreKept) {
  std::vector<double> values{1.0, 2.0, 3.0};
  std::string bytes;
  Archive writer([&](void const* from, std::size_t count) { bytes.append(static_cast<char const*>(from), count); });
  writer.sized(values, "the number of blocks");
  EXPECT_EQ(bytes, written(values));  // as any vector
  std::vector<double> same(3);
  reader(bytes).sized(same, "the number of blocks");
  EXPECT_EQ(same, values);
  for (std::size_t const size : {0U, 2U, 4U}) {
    std::vector<double> other(size);
    EXPECT_NE(problem([&] { reader(bytes).sized(other, "the number of blocks"); }).find("the number of blocks"),
              std::string::npos);
    EXPECT_EQ(other.size(), size);
  }
  EXPECT_NE(problem([&] { reader(bytes).require(false, "the time"); }).find("the value of the time is invalid"),
            std::string::npos);
  EXPECT_EQ(problem([&] { writer.require(false, "the time"); }), "");  // what is written is not judged
}

TEST(Archive, EndsAreKept) {
  Everything value;
  value.text = "some text";
  value.records.resize(3);
  std::string const whole = written(value);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::string const part = whole.substr(0, size);
    Everything read;
    EXPECT_NE(problem([&] { reader(part)(read); }), "") << size;
  }
  std::string const longer = whole + "x";
  Archive a = reader(longer);
  a(value);
  EXPECT_NE(problem([&] { a.end(); }).find("continue to byte"), std::string::npos);
}

// A count is the first thing of a vector: whatever it says, no more memory is taken than the bytes that follow justify.
TEST(Archive, HugeCountsAreRefusedBeforeTheyBecomeMemory) {
  for (std::uint64_t const count : {std::uint64_t{5}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    std::string bytes(sizeof count + 4, '\0');
    std::memcpy(bytes.data(), &count, sizeof count);
    std::vector<double> numbers;
    std::vector<Record> records;
    std::string text;
    std::map<std::string, double> map;
    auto const refused = [&](auto& value) {
      std::string const why = problem([&] { reader(bytes)(value); });
      EXPECT_NE(why.find("more than it can contain"), std::string::npos) << count << ": " << why;
    };
    refused(numbers);
    refused(records);
    refused(text);
    refused(map);
    EXPECT_EQ(numbers.capacity(), 0U);
    EXPECT_EQ(records.capacity(), 0U);
  }
}

TEST(Archive, PartsHaveNames) {
  std::string bytes;
  Archive a([&](void const* from, std::size_t count) { bytes.append(static_cast<char const*>(from), count); });
  a.section("gas");
  double value = 3.0;
  a(value);
  Archive right = reader(bytes);
  right.section("gas");
  double read = 0.0;
  right(read);
  EXPECT_EQ(read, 3.0);
  EXPECT_EQ(problem([&] { reader(bytes).section("points"); }),
            "section \"points\" should begin at byte 0 of its data, but \"gas\" was found");
  Archive shifted = reader(bytes);
  shifted.section("gas");
  EXPECT_NE(problem([&] { shifted.section("points"); }).find("something else"), std::string::npos);
  bytes[0] = 'x';
  EXPECT_NE(problem([&] { reader(bytes).section("gas"); }).find("something else"), std::string::npos);
}

TEST(Archive, WhatTheReaderKnowsMustBeTheSame) {
  std::string bytes;
  Archive a([&](void const* from, std::size_t count) { bytes.append(static_cast<char const*>(from), count); });
  a.same(5, "the number of blocks");
  EXPECT_EQ(problem([&] { reader(bytes).same(5, "the number of blocks"); }), "");
  EXPECT_EQ(problem([&] { reader(bytes).same(6, "the number of blocks"); }),
            "the number of blocks differs from the case as this program builds it");
}

// The check value of CRC-32 in the catalogue of parametrised CRC algorithms.
TEST(Checksum, IsTheCommonCrc32) {
  EXPECT_EQ(checksum("123456789", 9), 0xCBF43926U);
  EXPECT_EQ(checksum("6789", 4, checksum("12345", 5)), 0xCBF43926U);
}

}  // namespace
}  // namespace brisance
