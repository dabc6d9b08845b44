#include "shape/data_file.hpp"

#include <csv.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

#include "core/error.hpp"

namespace brisance::shape {

namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{256} << 20U;
constexpr std::size_t longest_text = 65536;  ///< of one column
constexpr double largest = 1e12;

}  // namespace

DataFile::DataFile(std::filesystem::path file) : path(std::move(file)) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) refuse("the file does not exist; check the name and the folder");
  if (!std::filesystem::is_regular_file(path, error)) refuse("this is not a file");
  auto const size = std::filesystem::file_size(path, error);
  if (!error && size > most_bytes) {
    refuse(fmt::format("it has {} MiB; allowed: at most {} MiB: cut out what lies in the domain", size >> 20U,
                       most_bytes >> 20U));
  }
  std::ifstream in(path, std::ios::binary);
  text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  if (!in || in.bad()) refuse("it cannot be read; check the permissions");
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);  // the mark of UTF-8
  if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
}

std::string DataFile::kind() const {
  std::string ending = path.extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c | 0x20);
  }
  return ending;
}

void DataFile::refuse(std::string const& message) const {
  throw InputError(fmt::format("file \"{}\": {}", path.string(), message));
}

void DataFile::refuse(long line, std::string const& message) const {
  refuse(fmt::format("line {}: {}", line, message));
}

std::optional<double> number_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(std::abs(value) <= largest)) return std::nullopt;
  return value;
}

std::string shown(std::string_view text) {
  std::string out(text.substr(0, 40));
  for (char& c : out) {
    if (c < ' ' || c > '~') c = '?';
  }
  return fmt::format("\"{}{}\"", out, text.size() > 40 ? "..." : "");
}

double CsvRow::number(std::size_t column) const {
  auto const value = number_of(texts[column]);
  if (value) return *value;
  file.refuse(line, fmt::format("{} is {}; write a number{}", columns[column], shown(texts[column]),
                                texts[column].find(',') != std::string_view::npos ? " with a decimal point" : ""));
}

std::optional<double> CsvRow::number_if_given(std::size_t column) const {
  if (texts[column].empty()) return std::nullopt;
  return number(column);
}

namespace {

/// The fields of a file, row by row, by libcsv.
class CsvParser {
 public:
  CsvParser(DataFile const& file, char separator) : file_(file) {
    if (csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI | CSV_APPEND_NULL) != 0) file.refuse("not enough memory");
    csv_set_delim(&parser_, static_cast<unsigned char>(separator));
    csv_set_blk_size(&parser_, 4096);
  }
  ~CsvParser() { csv_free(&parser_); }
  CsvParser(CsvParser const&) = delete;
  CsvParser& operator=(CsvParser const&) = delete;

  /// A line with its end; true where a row ends in it, which `fields` then holds.
  bool add(std::string_view text, long line) {
    if (complete_) fields.clear();
    if (fields.empty() && parser_.entry_pos == 0) first_line = line;
    complete_ = false;
    bool const sound = csv_parse(&parser_, text.data(), text.size(), field, row, this) == text.size();
    check(sound);
    if (parser_.entry_pos > longest_text)
      file_.refuse(first_line, "the text in double quotes that begins here does not end; close the quotes");
    return complete_;
  }

  /// The last row, where the file does not end with a line break.
  bool finish() {
    if (complete_) fields.clear();
    complete_ = false;
    check(csv_fini(&parser_, field, row, this) == 0);
    return complete_;
  }

  /// Does a row go on in the next line?
  [[nodiscard]] bool within() const { return !complete_ && (!fields.empty() || parser_.entry_pos > 0); }

  std::vector<std::string> fields;
  long first_line = 1;

 private:
  // libcsv calls these; they must not throw through its C frames.
  static void field(void* text, std::size_t size, void* self) {
    auto& fields = static_cast<CsvParser*>(self)->fields;
    fields.emplace_back(static_cast<char const*>(text), size);
  }
  static void row(int /*end*/, void* self) { static_cast<CsvParser*>(self)->complete_ = true; }

  void check(bool sound) {
    if (sound) return;
    file_.refuse(first_line, csv_error(&parser_) == CSV_EPARSE
                                 ? "a double quote stands within a text, or a text in double quotes does not end; "
                                   "put the whole text in double quotes and double those in it"
                                 : csv_strerror(csv_error(&parser_)));
  }

  DataFile const& file_;
  csv_parser parser_{};
  bool complete_ = false;
};

/// What separates the columns: the first of these that the line of their names contains.
char separator_of(std::string_view names) {
  for (char const c : {',', ';', '\t'}) {
    if (names.find(c) != std::string_view::npos) return c;
  }
  return ',';
}

/// Where the columns are; npos for one that the file does not have.
std::vector<std::size_t> positions(DataFile const& file, CsvParser const& parser,
                                   std::vector<std::string> const& columns, std::size_t needed) {
  std::vector<std::size_t> all;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    auto const found = std::find(parser.fields.begin(), parser.fields.end(), columns[c]);
    all.push_back(found == parser.fields.end() ? std::string::npos
                                               : static_cast<std::size_t>(found - parser.fields.begin()));
    if (found == parser.fields.end() && c < needed) {
      file.refuse(parser.first_line,
                  fmt::format("there is no column \"{}\"; the first line names the columns: it must contain {}",
                              columns[c], fmt::join(columns.begin(), columns.begin() + needed, ", ")));
    }
    if (found != parser.fields.end() && std::find(found + 1, parser.fields.end(), columns[c]) != parser.fields.end())
      file.refuse(parser.first_line, fmt::format("there are two columns \"{}\"; rename one of them", columns[c]));
  }
  return all;
}

}  // namespace

void read_csv(DataFile const& file, std::vector<std::string> const& columns, std::size_t needed,
              std::function<void(CsvRow const&)> const& use) {
  std::string_view const text = file.text;
  std::unique_ptr<CsvParser> parser;
  std::vector<std::size_t> where;
  std::size_t width = 0;
  CsvRow row{file, columns, 0, std::vector<std::string_view>(columns.size())};
  auto const take = [&] {
    if (where.empty()) {
      where = positions(file, *parser, columns, needed);
      width = parser->fields.size();
      return;
    }
    if (parser->fields.size() != width) {
      file.refuse(parser->first_line,
                  fmt::format("{} columns, but the first line names {}", parser->fields.size(), width));
    }
    row.line = parser->first_line;
    for (std::size_t c = 0; c < where.size(); ++c)
      row.texts[c] = where[c] == std::string::npos ? std::string_view() : std::string_view(parser->fields[where[c]]);
    use(row);
  };
  long line = 0;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const end = std::min(text.find('\n', at), text.size() - 1) + 1;
    std::string_view const one = text.substr(at, end - at);
    at = end;
    ++line;
    if (one.starts_with('#') && !(parser && parser->within())) continue;
    if (!parser) parser = std::make_unique<CsvParser>(file, separator_of(one));
    if (parser->add(one, line)) take();
  }
  if (parser && parser->finish()) take();
  if (where.empty()) {
    file.refuse(fmt::format("it is empty; its first line must name the columns {}",
                            fmt::join(columns.begin(), columns.begin() + needed, ", ")));
  }
}

}  // namespace brisance::shape
