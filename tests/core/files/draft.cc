#include "tests/core/files/draft.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace arap::testing {
namespace {

// Writes words and lines, counts the lines and finds the marked word.
class DraftWriter {
 public:
  explicit DraftWriter(const Draft& draft) : draft_(draft) {
    if (draft.byte_order_mark) out_.text = "\xef\xbb\xbf";
  }

  void Word(const std::string& word) {
    if (word.starts_with('@')) {
      out_.line = line_;
      out_.word = word.substr(1, word.find(' ') - 1);
    }
    out_.text += word.substr(word.starts_with('@') ? 1 : 0);
  }
  void Blank() { draft_.word_lines ? End() : Put(draft_.blank); }
  void End() {
    last_end_ = out_.text.size();
    Put(draft_.end);
    ++line_;
  }
  void Put(const std::string& text) { out_.text += text; }
  void Words(const std::vector<std::string>& words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (i > 0 && i + 1 == words.size() && !draft_.joint.empty()) {
        Put(draft_.joint);
        End();
      } else if (i > 0) {
        Blank();
      }
      Word(words[i]);
    }
  }
  void Lines(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      Word(line);
      End();
    }
  }
  DraftText Take() {
    if (!draft_.last_end) out_.text.resize(last_end_);
    return std::move(out_);
  }

 private:
  const Draft& draft_;
  DraftText out_;
  std::size_t line_ = 1;
  std::size_t last_end_ = 0;
};

// The words of each on a line, behind the keyword if there is one.
void WriteAll(const std::vector<std::vector<std::string>>& all, const std::string& keyword,
              bool one_line, const Draft& draft, DraftWriter& writer) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<std::string> words = all[i];
    if (!keyword.empty()) words.insert(words.begin(), keyword);
    writer.Words(words);
    if (one_line && i + 1 < all.size()) {
      writer.Blank();
    } else {
      if (!one_line) writer.Put(draft.tail);
      writer.End();
    }
  }
}

Draft Plain() {
  Draft draft;
  for (const Point3& p : SheetVertices()) {
    std::vector<std::string>& words = draft.vertices.emplace_back();
    for (const double x : p) words.push_back(std::to_string(static_cast<int>(x)));
  }
  return draft;
}

}  // namespace

std::vector<Point3> SheetVertices() {
  return {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {20, 10, 0}, {10, 4, 0}, {0, 10, 0}};
}

double SheetArea() { return 140; }

Draft PlainObj() {
  Draft draft = Plain();
  draft.faces = {{"1", "2", "5"}, {"1", "5", "6"}, {"2", "3", "4"}, {"2", "4", "5"}};
  return draft;
}

Draft PlainOff() {
  Draft draft = Plain();
  draft.faces = {
      {"3", "0", "1", "4"}, {"3", "0", "4", "5"}, {"3", "1", "2", "3"}, {"3", "1", "3", "4"}};
  draft.counts = {"6", "4", "0"};
  return draft;
}

DraftText ObjText(const Draft& draft) {
  DraftWriter writer(draft);
  writer.Lines(draft.before);
  if (!draft.faces_first) WriteAll(draft.vertices, "v", draft.one_line, draft, writer);
  writer.Lines(draft.between);
  WriteAll(draft.faces, "f", /*one_line=*/false, draft, writer);
  if (draft.faces_first) WriteAll(draft.vertices, "v", draft.one_line, draft, writer);
  writer.Lines(draft.after);
  return writer.Take();
}

DraftText OffText(const Draft& draft) {
  DraftWriter writer(draft);
  writer.Lines(draft.before);
  writer.Word(draft.header);
  if (draft.behind_header == "\n") {
    writer.End();
  } else {
    writer.Put(draft.behind_header);
  }
  writer.Words(draft.counts);
  writer.End();
  writer.Lines(draft.between);
  WriteAll(draft.vertices, "", draft.one_line, draft, writer);
  WriteAll(draft.faces, "", /*one_line=*/false, draft, writer);
  writer.Lines(draft.after);
  return writer.Take();
}

DraftText ListText(const Draft& draft) {
  DraftWriter writer(draft);
  writer.Lines(draft.before);
  WriteAll(draft.vertices, "", /*one_line=*/false, draft, writer);
  writer.Lines(draft.after);
  return writer.Take();
}

Oddities TextOddities() {
  return {
      {"byte_order_mark", "mark", [](Draft& d) { d.byte_order_mark = true; }},
      {"crlf", "end", [](Draft& d) { d.end = "\r\n"; }},
      {"cr", "end", [](Draft& d) { d.end = "\r"; }},
      {"no_last_end", "last", [](Draft& d) { d.last_end = false; }},
      {"tabs", "blank", [](Draft& d) { d.blank = "\t"; }},
      {"wide_blanks", "blank", [](Draft& d) { d.blank = " \t  "; }},
      {"blanks_at_the_end", "tail", [](Draft& d) { d.tail = " \t"; }},
      {"comments_behind", "tail", [](Draft& d) { d.tail = "# 7 7 7"; }},
      {"comments", "before",
       [](Draft& d) {
         d.before = {"# OFF", "", "#", "  # v 1 2 3"};
       }},
      {"comments_after", "after",
       [](Draft& d) {
         d.after = {"# end", " ", ""};
       }},
  };
}

namespace {

std::string& NumberOf(std::vector<std::string>& words) {
  return words[std::min<std::size_t>(1, words.size() - 1)];
}

std::function<void(Draft&)> EachNumber(std::function<std::string(const std::string&)> change) {
  return [change = std::move(change)](Draft& draft) {
    for (auto& words : draft.vertices) NumberOf(words) = change(NumberOf(words));
  };
}

std::function<void(Draft&)> BadNumber(const std::string& word) {
  return [word](Draft& draft) { NumberOf(draft.vertices[2]) = "@" + word; };
}

}  // namespace

Oddities NumberOddities() {
  return {
      {"plus_signs", "number", EachNumber([](const std::string& word) { return "+" + word; })},
      {"exponents", "number",
       EachNumber([](const std::string& word) { return word + ".000e+00"; })},
      {"capital_exponents", "number",
       EachNumber([](const std::string& word) { return word + ".0E-00"; })},
  };
}

Oddities BadNumbers() {
  return {
      {"nan", "bad", BadNumber("nan"), "is not a finite number"},
      {"infinity", "bad", BadNumber("-inf"), "is not a finite number"},
      {"overflow", "bad", BadNumber("-1e999"), "is too large for a number"},
      {"decimal_comma", "bad", BadNumber("1,5"), "is not a number (decimal comma?)"},
      {"rubbish_behind", "bad", BadNumber("1.5mm"), "is not a number"},
      {"half_an_exponent", "bad", BadNumber("1.5e"), "is not a number"},
      {"hexadecimal", "bad", BadNumber("0x10"), "is not a number"},
  };
}

Oddities Joined(std::initializer_list<Oddities> parts) {
  Oddities all;
  for (const Oddities& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

bool Trial::Has(const std::string& oddity) const {
  return std::find(names.begin(), names.end(), oddity) != names.end();
}

void TryAlonePaired(const Draft& plain, const Oddities& oddities,
                    const std::function<void(const Trial&)>& check) {
  const auto with = [](Trial trial, const Oddity& oddity) {
    oddity.change(trial.draft);
    if (oddity.complaint != nullptr) trial.complaint = oddity.complaint;
    if (oddity.warning != nullptr) trial.warnings.emplace_back(oddity.warning);
    trial.names.emplace_back(oddity.name);
    return trial;
  };
  for (std::size_t i = 0; i < oddities.size(); ++i) {
    const Oddity& first = oddities[i];
    const Trial alone = with({plain, nullptr, {}, {}}, first);
    {
      SCOPED_TRACE(first.name);
      check(alone);
    }
    for (std::size_t k = i + 1; k < oddities.size(); ++k) {
      if (std::string(first.group) == oddities[k].group) continue;
      SCOPED_TRACE(std::string(first.name) + ", " + oddities[k].name);
      check(with(alone, oddities[k]));
    }
  }
}

}  // namespace arap::testing
