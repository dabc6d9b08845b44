/// Bodies from STL files.
#pragma once

#include <filesystem>

#include "shape/mesh.hpp"

namespace brisance::shape {

/// The body in an STL file, ASCII or binary (told apart by the file's size and content, as many binary files begin with
/// "solid"). Every coordinate is multiplied by `scale`, for example 0.001 for a file in millimetres, and then moved by
/// `translation` [m]. Throws InputError with the file's name, what is wrong and the remedy.
[[nodiscard]] Mesh read_stl(std::filesystem::path const& file, double scale = 1.0,
                            Vec3 const& translation = {0.0, 0.0, 0.0});

}  // namespace brisance::shape
