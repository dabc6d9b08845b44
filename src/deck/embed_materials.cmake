# cmake -D OUTPUT=file.cpp -D FOLDER=materials -P embed_materials.cmake: writes the material files into a C++ source.
file(GLOB files "${FOLDER}/*.toml")
list(SORT files)
set(entries "")
foreach(file IN LISTS files)
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" bytes "${hex}")
  # One literal of hexadecimal escapes per file: nothing in the text can end it.
  string(APPEND entries "      {\"materials/${name}\", \"${bytes}\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "// Generated from materials/*.toml.
#include \"deck/embedded.hpp\"

namespace brisance::deck {

std::vector<EmbeddedFile> const& embedded_materials() {
  static std::vector<EmbeddedFile> const files{
${entries}  };
  return files;
}

}  // namespace brisance::deck
")
