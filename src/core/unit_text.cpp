#include "core/unit_text.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "core/unit_table.hpp"

namespace brisance::units {

std::mutex& lock() {
  static std::mutex mutex;
  return mutex;
}

ut_system* unit_system() {
  static ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    return ut_read_xml(nullptr);
  }();
  return system;
}

std::string shown(std::string_view text) {
  std::string out = "\"";
  for (char const c : text.substr(0, 40)) out += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  // Do not cut inside a UTF-8 character.
  if (text.size() > 40) {
    while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0U) == 0x80U) out.pop_back();
    if (!out.empty() && static_cast<unsigned char>(out.back()) >= 0xC0U) out.pop_back();
    out += "...";
  }
  return out + "\"";
}

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lowered(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower(c);
  return out;
}

struct Unit {
  Symbol const* symbol = nullptr;
  std::string_view prefix;
};

/// A symbol with or without a prefix, as written.
std::optional<Unit> unit_by_symbol(std::string_view word) {
  for (Symbol const& s : symbols) {
    if (word == s.word) return Unit{&s, {}};
  }
  for (Symbol const& s : symbols) {
    if (word.size() == s.word.size() + 1 && word.ends_with(s.word) &&
        s.prefixes.find(word.front()) != std::string_view::npos) {
      return Unit{&s, word.substr(0, 1)};
    }
  }
  return std::nullopt;
}

/// A name with or without a prefix, in the singular or plural.
std::optional<Unit> unit_by_name(std::string const& word) {
  auto const plain = [](std::string_view w) -> std::string_view {
    for (Name const& n : names) {
      if (w == n.word || (w.size() == n.word.size() + 1 && w.starts_with(n.word) && w.back() == 's')) return n.symbol;
    }
    return {};
  };
  if (auto const symbol = plain(word); !symbol.empty()) return unit_by_symbol(symbol);
  for (LongPrefix const& p : long_prefixes) {
    if (!word.starts_with(p.word)) continue;
    std::string_view const symbol = plain(std::string_view(word).substr(p.word.size()));
    if (symbol.empty()) continue;
    auto const unit = unit_by_symbol(symbol);
    std::size_t const at = unit ? unit->symbol->prefixes.find(p.letter) : std::string_view::npos;
    if (at != std::string_view::npos && unit->prefix.empty())
      return Unit{unit->symbol, unit->symbol->prefixes.substr(at, 1)};
  }
  return std::nullopt;
}

std::optional<Unit> find_unit(std::string_view word) {
  if (auto const unit = unit_by_symbol(word)) return unit;
  return unit_by_name(lowered(word));
}

/// The units that the word would be if case did not count: `"MPa" or "mPa"`.
std::string nearly(std::string_view word) {
  std::string const wanted = lowered(word);
  std::string out;
  auto const offer = [&](std::string const& unit) {
    if (lowered(unit) != wanted || unit == word) return;
    out += fmt::format("{}\"{}\"", out.empty() ? "" : " or ", unit);
  };
  for (Symbol const& s : symbols) {
    offer(std::string(s.word));
    for (char const prefix : s.prefixes) offer(std::string(1, prefix) + std::string(s.word));
  }
  // A megametre is none here, but what looks like one is near.
  if (word == "Mm" || word == "MM") return "\"mm\" or \"m\"";
  return out;
}

std::string_view remedy_in(auto const& table, std::string_view word) {
  for (Remedy const& r : table) {
    if (r.word == word) return r.text;
  }
  return {};
}

UnitPointer parse_unit(std::string const& text) { return UnitPointer(ut_parse(unit_system(), text.c_str(), UT_ASCII)); }

/// Reads a unit as a product of powers of the units above: `kg m2/s^2`, `J/(kg K)`, `s-1`, `1/s`. UDUNITS also reads
/// time stamps, logarithms, powers that are no whole numbers (m^0.5 as m^0 times 5) and numbers in between, and loses
/// memory at every syntax error; so it gets only what this writes.
class UnitText {
 public:
  explicit UnitText(std::string_view text) : text_(text), rest_(text) {}

  Reading read() {
    bool const fits = text_.size() <= longest;
    // "5 1/s" and "5/s".
    if (fits && (rest_.starts_with("1/") || rest_.starts_with("/"))) {
      rest_.remove_prefix(rest_.front() == '1' ? 1 : 0);
      out_ = "1";
      if (!factors()) return failed();
    } else if (!fits || !product()) {
      return failed();
    }
    if (!rest_.empty()) return failed();
    // Alone a temperature counts from the zero of its scale; in "J/(kg degC)" it is a difference.
    if (!shifted_.empty() && count_ == 1 && out_ == differences_) out_ = std::string(shifted_);
    Reading reading{parse_unit(out_), angle_, {}};
    if (!reading.unit) return failed();
    return reading;
  }

 private:
  static constexpr std::size_t longest = 60;
  std::string_view text_;
  std::string_view rest_;
  std::string out_;
  int angle_ = 0;
  int sign_ = 1;  ///< of the powers here: -1 below an odd number of slashes
  int count_ = 0;
  std::string_view shifted_;
  std::string_view differences_;
  std::string problem_;

  Reading failed() {
    if (problem_.empty()) problem_ = fmt::format("has the unknown unit {}{}", shown(text_), hint());
    return {nullptr, 0, std::move(problem_)};
  }

  /// What may be meant by a text that is no product of powers.
  [[nodiscard]] std::string hint() const {
    if (text_.find("**") != std::string_view::npos) {
      std::string power(text_);
      for (std::size_t at = power.find("**"); at != std::string::npos; at = power.find("**")) power.replace(at, 2, "^");
      return fmt::format("; did you mean {}?", shown(power));
    }
    auto const caret = text_.find('^');
    if (caret == 0) return "; write a power of ten as part of the number, as in 1e3";
    if (caret != std::string_view::npos) return "; powers of units must be integers other than 0, as in m^2 or s^-1";
    auto const dash = text_.find('-');
    if (dash != std::string_view::npos && dash > 0 && dash + 1 < text_.size() && letter(text_[dash + 1])) {
      std::string product(text_);
      product[dash] = ' ';
      return fmt::format("; did you mean {}?", shown(product));
    }
    if (text_ == "'") return "; did you mean \"ft\"?";
    if (text_ == "\"" || text_ == "''") return "; did you mean \"in\"?";
    return {};
  }

  static bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  static bool digit(char c) { return c >= '0' && c <= '9'; }
  [[nodiscard]] bool next(char c) const { return !rest_.empty() && rest_.front() == c; }
  bool take(char c) {
    if (!next(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  bool product() { return factor() && factors(); }

  bool factors() {
    while (!rest_.empty() && !next(')')) {
      bool const blank = take(' ');
      while (take(' ')) {
      }
      bool const over = take('/');
      bool const times = !over && (take('*') || take('.'));
      if (!blank && !over && !times) return false;
      while (take(' ')) {
      }
      out_ += over ? '/' : '.';
      if (over) sign_ = -sign_;
      bool const good = factor();
      if (over) sign_ = -sign_;
      if (!good) return false;
    }
    return true;
  }

  bool factor() {
    int const outer = angle_;
    ++count_;
    Symbol const* symbol = nullptr;
    if (take('(')) {
      out_ += '(';
      if (!product() || !take(')')) return false;
      out_ += ')';
    } else if (take('%')) {
      out_ += '%';
      return true;  // "50 %2" is a slip
    } else {
      std::size_t length = 0;
      while (length < rest_.size() && letter(rest_[length])) ++length;
      if (length == 0) return false;
      std::string_view const word = rest_.substr(0, length);
      rest_.remove_prefix(length);
      auto const unit = find_unit(word);
      if (!unit || is_remedied(word)) {
        unknown(word);
        return false;
      }
      symbol = unit->symbol;
      out_ += unit->prefix;
      out_ += symbol->udunits;
      if (!symbol->shifted.empty()) {
        shifted_ = symbol->shifted;
        differences_ = symbol->udunits;
      }
      if (symbol->is_angle) angle_ += sign_;
    }
    bool const power = take('^');
    bool const minus = take('-');
    int digits = 0;
    int exponent = 0;
    while (!rest_.empty() && digit(rest_.front())) {
      exponent = 10 * exponent + (rest_.front() - '0');
      rest_.remove_prefix(1);
      if (++digits > 2) return false;
    }
    if (digits == 0) return !power && !minus;
    if (exponent == 0) {
      if (symbol != nullptr && symbol->word == "g" && !power && !minus) unknown("g0");
      return false;
    }
    if (minus) exponent = -exponent;
    angle_ = outer + exponent * (angle_ - outer);
    out_ += fmt::format("^{}", exponent);
    return true;
  }

  /// Is it a unit by its letters, but another one to most people?
  static bool is_remedied(std::string_view word) {
    return !remedy_in(ambiguous, lowered(word)).empty() || !remedy_in(meant, word).empty();
  }

  void unknown(std::string_view word) {
    if (auto const choice = remedy_in(ambiguous, lowered(word)); !choice.empty()) {
      problem_ = fmt::format("has the ambiguous unit {}: write {}", shown(word), choice);
      return;
    }
    std::string better(remedy_in(meant, word));
    if (better.empty()) better = nearly(word);
    if (better.empty()) better = remedy_in(meant, lowered(word));
    bool const asked = better.find('?') != std::string::npos;
    // The whole unit is the better place to point at where the word does not tell.
    problem_ = fmt::format("has the unknown unit {}{}", shown(better.empty() ? text_ : word),
                           better.empty() ? hint() : fmt::format("; did you mean {}{}", better, asked ? "" : "?"));
  }
};

}  // namespace

Reading read_unit(std::string_view text) {
  if (text == "1") return {parse_unit("1"), 0, {}};
  return UnitText(text).read();
}

}  // namespace brisance::units
