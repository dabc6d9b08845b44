/// libFuzzer entry: whatever an STL file holds, the reader returns a body or throws InputError; and a body that it
/// returns is one: finite, with a volume, and with stretches inside that are in order.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.hpp"
#include "memory_file.hpp"
#include "shape/meshes.hpp"
#include "shape/stl.hpp"

namespace {

using namespace brisance;

void require(bool sound) {
  if (!sound) std::abort();
}

void check(shape::Mesh const& mesh) {
  require(mesh.triangle_count() >= 4 && mesh.volume() > 0.0 && std::isfinite(mesh.volume()));
  Vec3 middle{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) {
    double const low = mesh.lower()[d];
    double const high = mesh.upper()[d];
    require(std::isfinite(low) && std::isfinite(high) && low <= high);
    require(std::isfinite(mesh.centre()[d]));
    middle[d] = 0.5 * low + 0.5 * high;
    std::vector<double> const& faces = mesh.faces(d);
    require(std::is_sorted(faces.begin(), faces.end()) && faces.front() == low && faces.back() == high);
  }
  std::vector<shape::Span> spans;
  for (double const s : {0.0, 0.3, 0.5, 1.0}) {
    Vec3 x{0.0, 0.0, 0.0};
    for (int d = 0; d < 3; ++d) x[d] = mesh.lower()[d] + s * (mesh.upper()[d] - mesh.lower()[d]);
    mesh.spans(x[1], middle[2], spans);
    for (std::size_t n = 0; n < spans.size(); ++n) require(!(spans[n].to < spans[n].from));
    (void)mesh.contains(x);
    (void)mesh.touches(x, mesh.upper());
  }
}

std::string binary(std::vector<Vec3> const& corners) {
  std::string bytes(80, ' ');
  auto const add = [&](auto value) { bytes.append(reinterpret_cast<char const*>(&value), sizeof value); };
  add(static_cast<std::uint32_t>(corners.size() / 3));
  for (std::size_t n = 0; n + 2 < corners.size(); n += 3) {
    for (int d = 0; d < 3; ++d) add(0.0F);
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) add(static_cast<float>(corners[n + c][d]));
    }
    add(static_cast<std::uint16_t>(0));
  }
  return bytes;
}

std::string text(std::vector<Vec3> const& corners) {
  std::string out = "solid body\n";
  for (std::size_t n = 0; n + 2 < corners.size(); n += 3) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (int c = 0; c < 3; ++c) {
      out += "vertex";
      for (int d = 0; d < 3; ++d) out += " " + std::to_string(corners[n + c][d]);
      out += "\n";
    }
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid body\n";
}

void write_seeds() {
  using namespace shape::test;
  std::vector<Vec3> const box = cube({0.0, 0.0, 0.0}, {0.1, 0.2, 0.3});
  std::vector<Vec3> two = box;
  std::vector<Vec3> const other = cube({0.5, 0.0, 0.0}, {0.6, 0.2, 0.3});
  two.insert(two.end(), other.begin(), other.end());
  std::vector<Vec3> const tetrahedron{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 1},
                                      {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  int number = 0;
  for (std::vector<Vec3> const& body : {box, two, tetrahedron, ball({1.0, 2.0, 3.0}, 0.5, 4)}) {
    fuzz::write_seed("binary_" + std::to_string(number), binary(body));
    fuzz::write_seed("text_" + std::to_string(number++), text(body));
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  if (fuzz::seed_folder() == nullptr) return 0;
  write_seeds();
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  static fuzz::MemoryFile file;
  file.set({reinterpret_cast<char const*>(data), size});
  try {
    check(shape::read_stl(file.path(), size % 2 == 0 ? 1.0 : 1e-3, {0.0, 0.0, size % 3 == 0 ? 5.0 : 0.0}));
  } catch (InputError const& error) {
    require(std::strlen(error.what()) > 0);
  }
  return 0;
}
