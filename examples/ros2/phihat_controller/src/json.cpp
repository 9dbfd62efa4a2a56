#include "phihat_controller/json.hpp"

#include <charconv>
#include <stdexcept>
#include <system_error>

namespace phihat_ros
{

namespace
{

constexpr int DEEPEST = 64;

class Reader
{
public:
  explicit Reader(std::string_view text) : text_(text) {}

  Json document()
  {
    Json value = this->value(0);
    blank();
    if (at_ != text_.size()) {
      refuse("the document ends here, and there is more");
    }
    return value;
  }

private:
  [[noreturn]] void refuse(const std::string & why) const
  {
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i < at_ && i < text_.size(); ++i) {
      column = text_[i] == '\n' ? 1 : column + 1;
      line += text_[i] == '\n' ? 1 : 0;
    }
    throw std::runtime_error(
      "line " + std::to_string(line) + ", column " + std::to_string(column) + ": " + why);
  }

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void blank()
  {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos) {
      ++at_;
    }
  }

  void expect(char c)
  {
    if (peek() != c) {
      refuse(std::string("'") + c + "' is expected");
    }
    ++at_;
  }

  bool word(std::string_view word)
  {
    const bool there = text_.substr(at_, word.size()) == word;
    at_ += there ? word.size() : 0;
    return there;
  }

  Json value(int depth)
  {
    if (depth > DEEPEST) {
      refuse("nested deeper than " + std::to_string(DEEPEST));
    }
    blank();
    Json made;
    const char c = peek();
    if (c == '{') {
      made.kind = Json::Kind::Object;
      object(made, depth);
    } else if (c == '[') {
      made.kind = Json::Kind::List;
      list(made, depth);
    } else if (c == '"') {
      made.kind = Json::Kind::Text;
      made.text = string();
    } else if (c == '-' || (c >= '0' && c <= '9')) {
      made.kind = Json::Kind::Number;
      made.number = number();
    } else if (word("true")) {
      made.kind = Json::Kind::True;
    } else if (word("false")) {
      made.kind = Json::Kind::False;
    } else if (!word("null")) {
      refuse("a value is expected");
    }
    return made;
  }

  void object(Json & into, int depth)
  {
    expect('{');
    blank();
    if (peek() == '}') {
      ++at_;
      return;
    }
    for (;;) {
      blank();
      std::string key = string();
      for (const auto & member : into.members) {
        if (member.first == key) {
          refuse("the key \"" + key + "\" is there twice");
        }
      }
      blank();
      expect(':');
      Json inside = value(depth + 1);
      into.members.emplace_back(std::move(key), std::move(inside));
      blank();
      if (peek() == '}') {
        ++at_;
        return;
      }
      expect(',');
    }
  }

  void list(Json & into, int depth)
  {
    expect('[');
    blank();
    if (peek() == ']') {
      ++at_;
      return;
    }
    for (;;) {
      into.list.push_back(value(depth + 1));
      blank();
      if (peek() == ']') {
        ++at_;
        return;
      }
      expect(',');
    }
  }

  double number()
  {
    const std::size_t begin = at_;
    const auto digits = [this] {
        const std::size_t first = at_;
        while (peek() >= '0' && peek() <= '9') {
          ++at_;
        }
        return at_ - first;
      };
    at_ += peek() == '-' ? 1 : 0;
    const bool zero = peek() == '0';
    const std::size_t whole = digits();
    bool good = whole > 0 && !(zero && whole > 1);
    if (peek() == '.') {
      ++at_;
      good = digits() > 0 && good;
    }
    if (peek() == 'e' || peek() == 'E') {
      ++at_;
      at_ += peek() == '+' || peek() == '-' ? 1 : 0;
      good = digits() > 0 && good;
    }
    double value = 0.0;
    const char * const last = text_.data() + at_;
    const auto read = std::from_chars(text_.data() + begin, last, value);
    if (!good || read.ec != std::errc() || read.ptr != last) {
      refuse("not a number of a double's range");
    }
    return value;
  }

  unsigned hex4()
  {
    unsigned code = 0;
    const std::string_view four = text_.substr(at_, 4);
    const auto read = std::from_chars(four.data(), four.data() + four.size(), code, 16);
    if (four.size() != 4 || read.ec != std::errc() || read.ptr != four.data() + 4) {
      refuse("four hexadecimal digits are expected");
    }
    at_ += 4;
    return code;
  }

  void escaped(std::string & into)
  {
    static constexpr std::string_view KEYS = "\"\\/bfnrt", VALUES = "\"\\/\b\f\n\r\t";
    const char c = peek();
    ++at_;
    if (c != 'u') {
      const std::size_t which = c == '\0' ? std::string_view::npos : KEYS.find(c);
      if (which == std::string_view::npos) {
        refuse("no such escape");
      }
      into += VALUES[which];
      return;
    }
    unsigned code = hex4();
    if (code >= 0xD800 && code < 0xDC00 && word("\\u")) {
      const unsigned low = hex4();
      if (low < 0xDC00 || low > 0xDFFF) {
        refuse("half of a character");
      }
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
    } else if (code >= 0xD800 && code <= 0xDFFF) {
      refuse("half of a character");
    }
    const auto byte = [&into](unsigned bits) {into += static_cast<char>(bits);};
    if (code < 0x80) {
      byte(code);
    } else if (code < 0x800) {
      byte(0xC0 | code >> 6);
    } else if (code < 0x10000) {
      byte(0xE0 | code >> 12);
      byte(0x80 | (code >> 6 & 0x3F));
    } else {
      byte(0xF0 | code >> 18);
      byte(0x80 | (code >> 12 & 0x3F));
      byte(0x80 | (code >> 6 & 0x3F));
    }
    if (code >= 0x80) {
      byte(0x80 | (code & 0x3F));
    }
  }

  std::string string()
  {
    expect('"');
    std::string made;
    for (;;) {
      const char c = peek();
      if (at_ >= text_.size() || static_cast<unsigned char>(c) < 0x20) {
        refuse("the text does not end");
      }
      ++at_;
      if (c == '"') {
        return made;
      }
      if (c == '\\') {
        escaped(made);
      } else {
        made += c;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

const Json & Json::operator[](std::string_view name) const
{
  static const Json none;
  for (const auto & member : members) {
    if (member.first == name) {
      return member.second;
    }
  }
  return none;
}

Json read_json(std::string_view text)
{
  return Reader(text).document();
}

}  // namespace phihat_ros
