/// Shapes: the keys that tell what, how large and where.
#include "deck/schema_keys.hpp"

namespace brisance::deck {

std::vector<Key> joined(std::vector<Key> first, std::vector<Key> const& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::vector<Key> shape_keys(std::vector<std::string> shapes) {
  return {
      word("shape", std::move(shapes))
          .note("`sphere`; in planar2d and cylindrical1d `cylinder`, in planar1d `box`")
          .like("\"sphere\"")
          .means("Shape. In planar2d a cylinder is a disc and a box a rectangle; in axisymmetric2d a cylinder stands "
                 "around the "
                 "axis, a box turned around the axis is a ring; cylindrical1d and spherical1d know the concentric "
                 "cylinder "
                 "and sphere, and boxes as tubes and shells"),
      position("position")
          .note("the origin")
          .like("[0, 0, \"1.5 m\"]")
          .means("Centre of a sphere, cylinder or box; of a hemisphere the centre of its flat face"),
      number("radius", "m", smallest, far).like("\"50 mm\"").means("Radius of a sphere, hemisphere or cylinder"),
      number("length", "m", smallest, far).like("\"0.2 m\"").means("Length of a cylinder along its axis"),
      axis("axis")
          .note("`z`; in axisymmetric2d `y`")
          .like("\"z\"")
          .means("Direction of a cylinder's axis (in 3D; else it is fixed by the geometry): a letter or, except for a "
                 "charge, a vector of any length such as [1, 0, 1]"),
      face_normal("normal")
          .note("`+z`; in axisymmetric2d `+y`")
          .like("\"+z\"")
          .means("Side of its flat face on which a hemisphere lies: `+z` stands on the ground"),
      typed(Type::point, "size", "m", smallest, far)
          .like("[1, 1, \"20 cm\"]")
          .means("Edges of a box around `position`; instead of `lower` and `upper`"),
      position("lower").like("[2, -1, 0]").means("Low corner of a box"),
      position("upper").like("[3, 1, \"2.5 m\"]").means("High corner of a box"),
  };
}

namespace {

/// Shapes of bodies: those of everything else and meshes.
std::vector<Key> mesh_shape_keys(std::vector<std::string> shapes) {
  return joined(
      shape_keys(std::move(shapes)),
      {typed(Type::text, "file")
           .like("\"bracket.stl\"")
           .means("STL file of shape `stl` (3D only), relative to the deck: a closed surface; `position` moves it"),
       number("scale", "1", 1e-9, 1e9)
           .note("1")
           .like("0.001")
           .means("Factor on the coordinates of the STL file, 0.001 for a file in mm")});
}

Table const& part_table() {
  static Table const table{"A shape that is put together with others.",
                           mesh_shape_keys({"sphere", "hemisphere", "cylinder", "box", "stl"}),
                           {},
                           {}};
  return table;
}

}  // namespace

std::vector<Key> composed_shape_keys() {
  return joined(mesh_shape_keys({"sphere", "hemisphere", "cylinder", "box", "stl"}),
                {nested(Type::tables, "add", part_table())
                     .note("none")
                     .like("[{shape = \"sphere\", radius = \"5 mm\"}]")
                     .means("Shapes that are joined to it"),
                 nested(Type::tables, "cut", part_table())
                     .note("none")
                     .like("[{shape = \"cylinder\", radius = \"5 mm\", length = \"1 m\"}]")
                     .means("Shapes that are then cut out: holes"),
                 nested(Type::tables, "common", part_table())
                     .note("none")
                     .like("[{lower = [0, 0, 0], upper = [1, 1, 1], shape = \"box\"}]")
                     .means("Shapes outside of which nothing is kept, last of all")});
}

}  // namespace brisance::deck
