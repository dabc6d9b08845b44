/// Expressions of a place: `-100*x + sin(pi*y)`. Only this file and its source know the parser.
#pragma once

#include <memory>
#include <string>

#include "core/vec.hpp"

namespace brisance {

/// A function of x, y, z [m], from its text. One thread at a time evaluates it.
class Expression {
 public:
  /// Throws InputError where the text is no expression.
  explicit Expression(std::string const& text);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  [[nodiscard]] double operator()(Vec3 const& x);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace brisance
