#include "core/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <numbers>

#include "core/error.hpp"

namespace brisance {

namespace {

constexpr std::size_t longest = 1000;  ///< text [bytes]

/// A message of the parser, without the full stop behind it.
InputError in_words(mu::Parser::exception_type const& problem) {
  std::string text = problem.GetMsg();
  while (!text.empty() && text.back() == '.') text.pop_back();
  return InputError(text);
}

/// The parser knows assignments, which have no place here.
bool assigns(std::string const& text) {
  for (std::size_t at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    if (at + 1 < text.size() && text[at + 1] == '=') {
      ++at;
      continue;
    }
    if (at == 0 || std::string("<>!").find(text[at - 1]) == std::string::npos) return true;
  }
  return false;
}

}  // namespace

struct Expression::Parser {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  mu::Parser parser;
};

Expression::Expression(std::string const& text) : parser_(std::make_unique<Parser>()) {
  if (text.size() > longest)
    throw InputError(fmt::format("the expression has {} bytes; allowed: at most {}", text.size(), longest));
  if (assigns(text)) throw InputError("an expression has no =; compare with ==");
  try {
    mu::Parser& p = parser_->parser;
    p.DefineVar("x", &parser_->x);
    p.DefineVar("y", &parser_->y);
    p.DefineVar("z", &parser_->z);
    p.DefineConst("pi", std::numbers::pi);
    p.SetExpr(text);
    p.Eval();
    if (p.GetNumResults() > 1) throw InputError("it has several values, separated by commas; expected one");
  } catch (mu::Parser::exception_type const& problem) {
    throw in_words(problem);
  }
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

double Expression::operator()(Vec3 const& x) {
  parser_->x = x[0];
  parser_->y = x[1];
  parser_->z = x[2];
  try {
    return parser_->parser.Eval();
  } catch (mu::Parser::exception_type const& problem) {
    throw in_words(problem);
  }
}

}  // namespace brisance
