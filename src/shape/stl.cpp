#include "shape/stl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string_view>

#include "core/error.hpp"

namespace brisance::shape {

namespace {

constexpr std::size_t header_size = 84;    // 80 bytes of text, the number of triangles
constexpr std::size_t triangle_size = 50;  // normal, three corners, two bytes of attributes

[[noreturn]] void refuse(std::filesystem::path const& file, std::string const& message) {
  throw InputError(fmt::format("STL file \"{}\": {}", file.string(), message));
}

std::string contents(std::filesystem::path const& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) refuse(file, "the file does not exist; check the name and the folder");
  if (!std::filesystem::is_regular_file(file, error)) refuse(file, "this is not a file");
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in || in.bad()) refuse(file, "it cannot be read; check the permissions");
  return text;
}

template <typename T>
T little_endian(char const* bytes) {
  std::uint32_t bits = 0;
  for (int n = 3; n >= 0; --n) bits = (bits << 8U) | static_cast<unsigned char>(bytes[n]);
  T value{};
  static_assert(sizeof value == sizeof bits);
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

bool space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Text that begins with "solid", without the zero bytes that a binary file is full of.
bool looks_like_text(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size() && space(text[at])) ++at;
  std::string_view const head = text.substr(at, 5);
  std::string_view const word = "solid";
  bool const solid = head.size() == word.size() &&
                     std::equal(head.begin(), head.end(), word.begin(), [](char a, char b) { return (a | 0x20) == b; });
  return solid && text.substr(0, 4096).find('\0') == std::string_view::npos;
}

std::vector<Vec3> read_binary(std::filesystem::path const& file, std::string_view bytes) {
  if (bytes.size() < header_size) {
    refuse(file, fmt::format("{} bytes are too few for an STL file, and it does not begin with \"solid\"; export the "
                             "body again",
                             bytes.size()));
  }
  std::uint64_t const count = little_endian<std::uint32_t>(bytes.data() + 80);
  std::uint64_t const held = (bytes.size() - header_size) / triangle_size;
  if (held < count) {
    refuse(file,
           fmt::format(
               "it declares {} triangles but contains {}: it is truncated or not an STL file; export the body again",
               count, held));
  }
  std::vector<Vec3> corners;
  corners.reserve(3 * count);
  for (std::uint64_t n = 0; n < count; ++n) {
    char const* at = bytes.data() + header_size + n * triangle_size + 12;
    for (int c = 0; c < 3; ++c, at += 12) {
      corners.push_back({static_cast<double>(little_endian<float>(at)),
                         static_cast<double>(little_endian<float>(at + 4)),
                         static_cast<double>(little_endian<float>(at + 8))});
    }
  }
  return corners;
}

/// The words of an ASCII file, with the line for messages.
class Words {
 public:
  Words(std::filesystem::path const& file, std::string_view text) : file_(file), text_(text) {}

  /// The next word, lower case; empty at the end of the file.
  std::string next() {
    while (at_ < text_.size() && space(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
    std::size_t const begin = at_;
    while (at_ < text_.size() && !space(text_[at_])) ++at_;
    std::string word(text_.substr(begin, at_ - begin));
    for (char& c : word) {
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c | 0x20);
    }
    return word;
  }

  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

  void expect(std::string_view wanted) {
    std::string const word = next();
    if (word != wanted) unexpected(word, fmt::format("\"{}\"", wanted));
  }

  double number() {
    std::string const word = next();
    char const* first = word.data();
    char const* const last = word.data() + word.size();
    if (first != last && *first == '+') ++first;
    double value = 0.0;
    auto const [end, error] = std::from_chars(first, last, value);
    // A number too small for a double is zero; one too large is no coordinate.
    bool const tiny = error == std::errc::result_out_of_range && word.find("e-") != std::string::npos;
    if (tiny) return 0.0;
    if (error != std::errc() || end != last) unexpected(word, "a number");
    return value;
  }

  [[noreturn]] void unexpected(std::string const& word, std::string const& wanted) const {
    if (at_ >= text_.size()) {
      refuse(file_, fmt::format("it ends in line {} where {} is expected: it is truncated; export the body again",
                                line_, wanted));
    }
    std::string shown = word.substr(0, 30);
    for (char& c : shown) {
      if (c < ' ' || c > '~') c = '?';
    }
    refuse(file_, fmt::format("line {}: found \"{}\", expected {}; export the body again", line_, shown, wanted));
  }

 private:
  std::filesystem::path const& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  long line_ = 1;
};

std::vector<Vec3> read_text(std::filesystem::path const& file, std::string_view text) {
  Words words(file, text);
  std::vector<Vec3> corners;
  for (std::string word = words.next(); !word.empty(); word = words.next()) {
    if (word == "solid" || word == "endsolid") {
      words.skip_line();  // the rest is a name
      continue;
    }
    if (word != "facet") words.unexpected(word, "\"facet\" or \"endsolid\"");
    words.expect("normal");
    for (int d = 0; d < 3; ++d) (void)words.next();  // normals are often wrong or \"nan\": the corners decide
    words.expect("outer");
    words.expect("loop");
    for (int c = 0; c < 3; ++c) {
      words.expect("vertex");
      double const x = words.number();
      double const y = words.number();
      double const z = words.number();
      corners.push_back({x, y, z});
    }
    words.expect("endloop");
    words.expect("endfacet");
  }
  return corners;
}

}  // namespace

Mesh read_stl(std::filesystem::path const& file, double scale, Vec3 const& translation) {
  if (!(scale > 0.0) || !std::isfinite(scale)) refuse(file, "the scale must be a positive number");
  std::string const bytes = contents(file);
  bool const sized =
      bytes.size() >= header_size && bytes.size() == header_size + static_cast<std::uint64_t>(triangle_size) *
                                                                       little_endian<std::uint32_t>(bytes.data() + 80);
  std::vector<Vec3> corners = !sized && looks_like_text(bytes) ? read_text(file, bytes) : read_binary(file, bytes);
  for (Vec3& x : corners) x = scale * x + translation;
  return {corners, fmt::format("STL file \"{}\"", file.string())};
}

}  // namespace brisance::shape
