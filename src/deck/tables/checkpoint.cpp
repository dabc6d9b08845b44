/// [checkpoint]: when the whole state is written.
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<run::Checkpoint> const& settings() {
  using C = run::Checkpoint;
  static Settings<C> const all{
      {&C::interval,
       number("interval", "s", 0.0, longest).like("\"1 ms\"").means("Simulated time between checkpoints; 0: off")},
      {&C::steps, typed(Type::integer, "steps", "1", 0, 1e12).like("1000").means("Steps between checkpoints; 0: off")},
      {&C::wall_clock,
       number("wall_clock", "s", 0.0, 1e8)
           .like("\"30 min\"")
           .means(
               "Wall-clock time between checkpoints; longer if writing one takes more than a twentieth of it; 0: off")},
      {&C::keep, typed(Type::integer, "keep", "1", 1, 1000)
                     .like("2")
                     .means("Number of checkpoints kept on disk (the newest ones)")},
      {&C::at_end, typed(Type::boolean, "at_end").like("true").means("Write one at the end of the simulation")},
      {&C::on_signal,
       typed(Type::boolean, "on_signal").like("true").means("Write one when Ctrl-C or a signal stops the run")}};
  return all;
}

}  // namespace

Table const& checkpoint_table() {
  static Table const table{
      "When to write the whole state, so that `brisance run --resume` can continue from there. Nothing here changes "
      "the results.",
      settings().keys(),
      {},
      {}};
  return table;
}

void build_checkpoint(Draft& draft) {
  if (auto const* section = draft.deck.section("checkpoint")) settings().read(*section, draft.out.checkpoint);
}

}  // namespace brisance::deck
