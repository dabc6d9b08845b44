/// Short vectors of doubles that the compiler keeps in one or a few registers: the components of one record side by
/// side, where a loop over particles cannot be vectorised because neighbours write to the same node. A GCC and clang
/// extension; on machines with shorter registers the compiler splits them.
#pragma once

namespace brisance {

using Lanes4 = double __attribute__((vector_size(32), may_alias));
/// Four numbers from anywhere in memory.
using LooseLanes4 = double __attribute__((vector_size(32), may_alias, aligned(8)));

}  // namespace brisance
