#include "session/session.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/simd.hpp"
#include "core/text.hpp"
#include "deck/deck.hpp"
#include "output/file.hpp"
#include "output/profile_file.hpp"
#include "output/run_log.hpp"
#include "setup/profile_fit.hpp"

namespace brisance::session {

namespace fs = std::filesystem;

namespace {

/// Did a run of this very deck reach its end in the folder?
bool has_finished(fs::path const& folder, run::Case const& setup) {
  try {
    auto const log = nlohmann::json::parse(output::read_file(folder / "run.json"));
    return log.at("status") == "done" && log.at("deck") == setup.deck_text;
  } catch (IoError const&) {
    return false;
  } catch (nlohmann::json::exception const&) {
    return false;
  }
}

/// Is the folder one that this user cannot write, but may look at?
bool is_read_only(fs::path const& folder) { return access(folder.c_str(), W_OK) != 0; }

/// The lock for a run in the folder, unless it is a finished one: then null.
std::unique_ptr<output::FolderLock> lock_of(fs::path const& folder, Settings const& settings, run::Case const& setup) {
  if (!settings.resume) return std::make_unique<output::FolderLock>(folder);
  // Without a folder there is no run either, and none is made.
  if (!fs::is_directory(folder)) return nullptr;
  if (is_read_only(folder) && has_finished(folder, setup)) return nullptr;
  auto lock = std::make_unique<output::FolderLock>(folder);
  return has_finished(folder, setup) ? nullptr : std::move(lock);
}

/// The newest good checkpoint of the folder. Throws where there is none, or where it is of another case.
std::unique_ptr<output::CheckpointReader> checkpoint_of(fs::path const& folder, run::Case const& setup,
                                                        std::function<void(std::string const&)> const& tell) {
  auto found = output::newest_checkpoint(folder);
  std::vector<std::string> warnings;
  for (auto const& problem : found.problems) warnings.push_back("warning: " + problem);
  if (!warnings.empty()) tell(listed(warnings));
  if (found.reader == nullptr) {
    throw IoError(
        fmt::format("--resume: \"{}\" contains no {}checkpoint: the run ended before it wrote one, or --output names "
                    "another folder; start again with --force instead of --resume",
                    folder.string(), found.problems.empty() ? "" : "valid "));
  }
  auto const& info = found.reader->info();
  if (auto const key = deck::difference(info.deck, setup.deck_text)) {
    throw InputError(
        fmt::format("--resume: {} of \"{}\" differs from the deck that was used for \"{}\"; only [end], [output] "
                    "(except peak_fields), [checkpoint], [audit] and the title may change; start again with --force, "
                    "or see {} for the earlier deck",
                    *key, setup.deck_path, found.reader->path().string(), (folder / "deck.toml").string()));
  }
  if (!found.problems.empty()) tell(fmt::format("using the checkpoint \"{}\"\n", found.reader->path().string()));
  if (info.program != output::program_build()) {
    tell(
        fmt::format("warning: \"{}\" was written by another build of the program ({}): the last digits of the results "
                    "may differ from those of an uninterrupted run\n",
                    found.reader->path().string(), info.program));
  }
  for (auto const& refused : found.refused) output::put_aside(refused);
  return std::move(found.reader);
}

}  // namespace

void load_profile(run::Case& setup) {
  run::Start& start = setup.start;
  if (start.profile.empty()) return;
  detonation::Profile const profile = output::read_profile(start.profile);
  try {
    for (std::size_t n = 0; n < setup.charges.size(); ++n)
      start.profiles.push_back(setup::fitted_profile(setup, n, profile));
  } catch (InputError const& problem) {
    throw InputError(fmt::format("{}: {}", start.place, problem.what()));
  }
}

Session::Session(run::Case setup, Settings settings)
    : settings_(std::move(settings)), setup_(std::move(setup)), plan_(session::plan(setup_)) {
  refuse_unless_it_fits(plan_);
  if (!settings_.resume) load_profile(setup_);
  settings_.folder = output::real_folder(settings_.folder);
  lock_ = lock_of(settings_.folder, settings_, setup_);
  if (lock_ != nullptr && !lock_->warning().empty()) settings_.tell(fmt::format("warning: {}\n", lock_->warning()));
  if (!settings_.resume) return;
  had_finished_ = lock_ == nullptr && has_finished(settings_.folder, setup_);
  if (!had_finished_) checkpoint_ = checkpoint_of(settings_.folder, setup_, settings_.tell);
  setup_.start.from_checkpoint = checkpoint_ != nullptr;
}

bool Session::calculate_start(setup::StartObserver const& observer) {
  if (!setup_.start.remap || checkpoint_ != nullptr || !setup_.start.profiles.empty()) return true;
  auto const begin = std::chrono::steady_clock::now();
  setup_.start.profiles = setup::calculate_start(setup_, observer);
  start_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return !setup_.start.profiles.empty();
}

void Session::build() {
  world_.emplace(setup::build(std::move(setup_)));
  gauges_.emplace(*world_);
  if (world_->setup.start.remap && checkpoint_ == nullptr) world_->timings["start"] += start_seconds_;
  if (checkpoint_ != nullptr) read_world();
  // One more than stay: the newest is complete before the oldest goes.
  double const kept = (world_->setup.checkpoint.keep + 1) * output::state_bytes([this](Archive& a) {
                        world_->archive(a);
                        gauges_->archive(a, *world_);
                      });
  writer_.emplace(*world_, *gauges_, settings_.folder,
                  output::WriterOptions{.earlier = checkpoint_ != nullptr ? output::Earlier::keep
                                                   : settings_.force      ? output::Earlier::replace
                                                                          : output::Earlier::refuse,
                                        .checkpoint_bytes = kept});
  if (checkpoint_ == nullptr) output::write_start_profiles(*world_, settings_.folder);
}

Ending Session::run(std::atomic<bool> const& stop, std::function<void(run::World const&)> const& after_step) {
  Archive* const resumed = checkpoint_ != nullptr ? &checkpoint_->archive() : nullptr;
  return drive(*world_, *gauges_, *writer_, stop, after_step, resumed, settings_.begin);
}

void Session::read_world() {
  try {
    world_->archive(checkpoint_->archive());
    gauges_->archive(checkpoint_->archive(), *world_);
  } catch (IoError const& problem) {
    throw IoError(
        fmt::format("--resume: the checkpoint \"{}\" does not match this case: {}; the program or a file named in the "
                    "deck has changed: restore it, or start again with --force instead of --resume",
                    checkpoint_->path().string(), problem.what()));
  }
  // The same instructions as before give the same bits as a run that was never interrupted.
  SimdSet const before = world_->written_with;
  if (before == simd_set()) return;
  if (!simd_set_is_specified() && has_simd_set(before)) {
    use_simd_set(before);
    return;
  }
  settings_.tell(
      fmt::format("warning: the run began with the vector instructions {} and goes on with {}: its last "
                  "digits will differ from those of a run without a stop\n",
                  word_of(before), word_of(simd_set())));
}

}  // namespace brisance::session
