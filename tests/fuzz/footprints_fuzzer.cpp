/// libFuzzer entry: whatever a file of footprints or heights holds, the readers return a body or throw InputError; and
/// a body that they return is one: finite, with a volume. The first byte chooses the reader.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/error.hpp"
#include "memory_file.hpp"
#include "shape/buildings.hpp"
#include "shape/heights.hpp"

namespace {

using namespace brisance;

constexpr char const* endings[] = {".geojson", ".csv", ".csv", ".asc", ".geojson", ".csv"};

void require(bool sound) {
  if (!sound) std::abort();
}

void check(shape::Mesh const& mesh) {
  require(mesh.triangle_count() >= 4 && mesh.volume() > 0.0 && std::isfinite(mesh.volume()));
  Vec3 const middle = 0.5 * (mesh.lower() + mesh.upper());
  std::vector<shape::Span> spans;
  mesh.spans(middle[1], middle[2], spans);
  for (shape::Span const& s : spans) require(!(s.to < s.from));
  (void)mesh.contains(middle);
}

void read(std::size_t which, std::filesystem::path const& path) {
  shape::Frame const frame{{1.0, 2.0, 0.0}, 1.0, {0.0, 0.0, 3.0}};
  if (which < 2) {
    check(shape::read_buildings({path, "height", "base", 5.0, frame}));
    return;
  }
  auto const heights = which == 5 ? shape::read_profile(path, frame) : shape::read_heights(path, frame);
  check(shape::ground(heights, heights.lowest() - 1.0, "it"));
}

void write_seeds() {
  std::string const ring = "[[0, 0], [9, 0], [9, 7], [0, 7], [0, 0]]";
  std::string const hole = "[[1, 1], [3, 1], [3, 3], [1, 3], [1, 1]]";
  auto const feature = [](std::string const& type, std::string const& coordinates) {
    return R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"height": "3 m", "base": 1},
"geometry": {"type": ")" +
           type + R"(", "coordinates": )" + coordinates + "}}]}";
  };
  std::string const seeds[] = {
      feature("Polygon", '[' + ring + ',' + hole + ']'),
      "building;x;y;height;ring\n\"a\";0;0;3;\na;9;0;;\na;0;9;;\n# b\na;1;1;;1\na;2;1;;1\na;1;2;;1\n",
      "x,y,z\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n",
      "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nnodata_value -9\n1 2\n3 4\n",
      feature("MultiPoint", "[[0, 0, 1], [1, 0, 2], [0, 1, 3], [1, 1, 4]]"),
      "x,z\n0,1\n1,3\n2,2\n"};
  for (std::size_t n = 0; n < std::size(seeds); ++n) {
    std::string bytes(1, static_cast<char>('0' + n));
    fuzz::write_seed("seed_" + std::to_string(n), bytes + seeds[n]);
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  if (fuzz::seed_folder() == nullptr) return 0;
  write_seeds();
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  if (size == 0 || data[0] < '0' || data[0] >= '0' + std::size(endings)) return 0;
  std::size_t const which = data[0] - '0';
  static fuzz::MemoryFile file;
  file.set({reinterpret_cast<char const*>(data) + 1, size - 1});
  // The name tells the reader the format.
  auto const link =
      std::filesystem::temp_directory_path() / ("brisance-fuzz-" + std::to_string(getpid()) + endings[which]);
  std::error_code ignored;
  std::filesystem::remove(link, ignored);
  std::filesystem::create_symlink(file.path(), link);
  try {
    read(which, link);
  } catch (InputError const& error) {
    require(std::strlen(error.what()) > 0);
  }
  std::filesystem::remove(link, ignored);
  return 0;
}
