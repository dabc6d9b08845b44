/// [checkpoint]: when the whole state is written.
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

Table const& checkpoint_table() {
  static Table const table = [] {
    run::Checkpoint const c;
    return Table{
        "When the whole state is written, so that `brisance run --resume` can go on from there. Nothing here changes "
        "the "
        "results.",
        {number("interval", "s", 0.0, longest)
             .of(c.interval)
             .like("\"1 ms\"")
             .means("Simulated time between two checkpoints; 0: not by the simulated time"),
         typed(Type::integer, "steps", "1", 0, 1e12)
             .of(c.steps)
             .like("1000")
             .means("Steps between two checkpoints; 0: not by steps"),
         number("wall_clock", "s", 0.0, 1e8)
             .of(c.wall_clock)
             .like("\"30 min\"")
             .means("Time of the clock on the wall between two checkpoints, more where writing one takes more than a "
                    "twentieth of it; 0: not by the clock"),
         typed(Type::integer, "keep", "1", 1, 1000)
             .of(static_cast<long>(c.keep))
             .like("2")
             .means("Number of checkpoints that stay on the disk, the newest ones"),
         typed(Type::boolean, "at_end").of(c.at_end).like("true").means("Write one at the end of the calculation"),
         typed(Type::boolean, "on_signal")
             .of(c.on_signal)
             .like("true")
             .means("Write one when the run is stopped by Ctrl-C or a signal")},
        {},
        {}};
  }();
  return table;
}

void build_checkpoint(Draft& draft) {
  Section const* section = draft.deck.section("checkpoint");
  if (section == nullptr) return;
  auto& c = draft.out.checkpoint;
  c.interval = section->number("interval").value_or(c.interval);
  c.steps = section->integer("steps").value_or(c.steps);
  c.wall_clock = section->number("wall_clock").value_or(c.wall_clock);
  c.keep = static_cast<int>(section->integer("keep").value_or(c.keep));
  c.at_end = section->boolean("at_end").value_or(c.at_end);
  c.on_signal = section->boolean("on_signal").value_or(c.on_signal);
}

}  // namespace brisance::deck
