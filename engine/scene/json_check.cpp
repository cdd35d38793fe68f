#include "engine/scene/json_check.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"

namespace etalon {

namespace {

using nlohmann::json;

class Counter : public nlohmann::json_sax<json> {
 public:
    explicit Counter(const Limits& limits) : limits_(limits) {}

    bool null() override { return value(); }
    bool boolean(bool) override { return value(); }
    bool number_integer(number_integer_t) override { return value(); }
    bool number_unsigned(number_unsigned_t) override { return value(); }
    bool number_float(number_float_t, const string_t&) override { return value(); }
    bool string(string_t&) override { return value(); }
    bool binary(binary_t&) override { return value(); }
    bool start_object(std::size_t) override { return open(); }
    bool start_array(std::size_t) override { return open(); }
    bool key(string_t&) override { return true; }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool parse_error(std::size_t, const std::string&, const json::exception& error) override
    {
        throw Error(Blame::input, fmt::format("this is not glTF: {} [INVALID_JSON]", error.what()),
                    "a .gltf file is JSON text, a .glb file begins with the letters glTF");
    }

 private:
    bool value()
    {
        if (++values_ > limits_.json_values)
            throw Error(Blame::input, fmt::format("the JSON has more than {} values", limits_.json_values),
                        "split the file");
        return true;
    }
    bool open()
    {
        if (++depth_ > limits_.json_depth)
            throw Error(Blame::input, fmt::format("the JSON is nested more than {} deep", limits_.json_depth),
                        "no glTF needs that: look into extras and extensions");
        return value();
    }
    bool close()
    {
        --depth_;
        return true;
    }

    const Limits& limits_;
    std::size_t depth_ = 0;
    std::size_t values_ = 0;
};

}  // namespace

void check_json(std::string_view text, const Limits& limits)
{
    Counter counter(limits);
    json::sax_parse(text.begin(), text.end(), &counter);
}

}  // namespace etalon
