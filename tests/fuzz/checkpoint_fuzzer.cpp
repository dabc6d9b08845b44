/// libFuzzer entry: checkpoints. The first byte chooses: the file as it is, or data behind a header and with a checksum
/// that fit them, read into the world of a small case. Whatever they hold, the world has read them, and can be looked
/// at, or IoError is thrown.
#include <array>
#include <cstring>
#include <optional>
#include <vector>

#include "../observe/watched.hpp"
#include "core/archive.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "deck/deck.hpp"
#include "memory_file.hpp"
#include "output/checkpoint.hpp"
#include "run/world.hpp"

namespace {

using namespace brisance;

void require(bool sound) {
  if (!sound) std::abort();
}

constexpr std::array decks{
    // A burst with two fluids, gauges, peak fields and a slow afterburn.
    R"([domain]
geometry = "spherical1d"
size = 1
cell = 0.0625
[[charge]]
mass = "100 kg"
[[gauge]]
point = 0.5
[[gauge]]
point = 0.9
[end]
time = "1 ms"
)",
    // Particles that carry much, with a load and gauges of a particle and of a body.
    R"([domain]
geometry = "planar2d"
size = [0.08, 0.08]
cell = 0.01
[[body]]
name = "plate"
material = "OFHC-copper"
shape = "box"
lower = [0.02, 0.02]
upper = [0.04, 0.05]
velocity = [10, 0]
[[surface_pressure]]
body = "plate"
normal = "-x"
pressure = "1 MPa"
[[gauge]]
body = "plate"
[[gauge]]
body = "plate"
point = [0.03, 0.03]
[end]
time = "1 ms"
)",
    // Gas and particles.
    R"([domain]
geometry = "planar1d"
size = 0.4
cell = 0.01
[mpm_region]
box = {lower = 0.2, upper = 0.4}
[[gauge]]
point = 0.1
[[initial_state]]
shape = "box"
lower = 0.0
upper = 0.05
pressure = "1 MPa"
[[body]]
name = "plate"
material = "OFHC-copper"
shape = "box"
lower = 0.35
upper = 0.38
[end]
time = "1 ms"
)",
};

run::Case const& case_of(std::size_t number) {
  static std::array<std::optional<run::Case>, decks.size()> cases;
  if (!cases[number]) {
    auto result = deck::read_text(decks[number], "fuzz");
    if (!result.case_) {
      for (auto const& error : result.errors) std::fprintf(stderr, "%s\n", deck::format(error).c_str());
      std::abort();
    }
    cases[number] = std::move(*result.case_);
  }
  return *cases[number];
}

/// The state of a case after some steps, as a checkpoint holds it behind its header.
std::string state_of(std::size_t number, int steps) {
  observe::Watched world(case_of(number));
  for (int n = 0; n < steps; ++n) {
    world.sample_gauges();
    run::advance(world, world.setup.end.time);
  }
  fuzz::MemoryFile file;
  std::string bytes;
  Archive archive([&](void const* from, std::size_t count) { bytes.append(static_cast<char const*>(from), count); });
  output::CheckpointInfo info{output::program_build(), world.setup.deck_text, world.clock.step, world.clock.time};
  archive.section("checkpoint");
  archive(info.program, info.deck, info.step, info.time);
  world.archive(archive);
  return bytes;
}

/// A file as `write_checkpoint` makes it, around data of which nothing is known.
std::string with_header(std::string_view data) {
  static std::string const header = [] {
    std::filesystem::path const folder =
        std::filesystem::temp_directory_path() / ("brisance_" + std::to_string(::getpid()));
    std::filesystem::path const path = folder / "checkpoint.brz";
    output::write_checkpoint(path, {}, [](Archive& /*archive*/) {});
    std::ifstream in(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    std::filesystem::remove_all(folder);
    return bytes.substr(0, 36);
  }();
  std::string file = header;
  std::uint32_t const sum = checksum(data.data(), data.size());
  std::uint64_t const size = data.size();
  std::memcpy(file.data() + 20, &sum, sizeof sum);
  std::memcpy(file.data() + 24, &size, sizeof size);
  std::uint32_t const whole = checksum(file.data(), 32);
  std::memcpy(file.data() + 32, &whole, sizeof whole);
  file += data;
  return file;
}

void read(std::size_t number, std::filesystem::path const& path) {
  output::CheckpointReader reader(path);
  require(reader.archive().reading());
  observe::Watched world(case_of(number));
  world.archive(reader.archive());
  // What a resumed run does first.
  world.sample_gauges();
  (void)world.totals();
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  set_threads(1);
  // The fuzzer would test nothing if what it takes for good were not.
  fuzz::MemoryFile file;
  for (std::size_t number = 0; number < decks.size(); ++number) {
    for (int const steps : {0, 3}) {
      std::string const state = state_of(number, steps);
      file.set(with_header(state));
      read(number, file.path());
      if (fuzz::seed_folder() == nullptr) continue;
      std::string const name = std::to_string(number) + "_" + std::to_string(steps);
      fuzz::write_seed("state_" + name, static_cast<char>(number) + state);
      fuzz::write_seed("file_" + name, static_cast<char>(255) + with_header(state));
    }
  }
  if (fuzz::seed_folder() != nullptr) std::exit(0);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  static fuzz::MemoryFile file;
  fuzz::Bytes in(data, size);
  std::uint8_t const choice = in.byte();
  bool const raw = choice >= 192;
  file.set(raw ? std::string(in.rest()) : with_header(in.rest()));
  try {
    read(choice % decks.size(), file.path());
  } catch (IoError const& error) {
    require(std::strlen(error.what()) > 0);
  }
  return 0;
}
