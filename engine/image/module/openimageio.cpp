// The one includer of OpenImageIO: the module libetalon_pictures.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <memory>
#include <stdexcept>

#include "engine/image/picture_library.h"

namespace etalon::codec {
namespace {

std::string plugin(Format format)
{
    switch (format) {
        case Format::png:
            return "png";
        case Format::jpeg:
            return "jpeg";
        case Format::webp:
            return "webp";
        case Format::hdr:
            return "hdr";
        case Format::exr:
            return "openexr";
    }
    return {};
}

std::logic_error lacks(const std::string& what, Format format)
{
    return std::logic_error("OpenImageIO here cannot " + what + " " + plugin(format) + ": " + OIIO::geterror());
}

template <typename T>
void read_values(OIIO::ImageInput& input, int first, int end, OIIO::TypeDesc type, std::vector<T>& out)
{
    const OIIO::ImageSpec& spec = input.spec();
    out.resize(std::size_t(spec.width) * std::size_t(spec.height) * std::size_t(end - first));
    if (!input.read_image(0, 0, first, end, type, out.data())) throw std::runtime_error(input.geterror());
}

void read_pixels(OIIO::ImageInput& input, Picture& picture)
{
    const OIIO::ImageSpec spec = input.spec();
    const int channels = spec.nchannels;
    if (picture.format == Format::exr || picture.format == Format::hdr) {
        read_values(input, 0, channels, OIIO::TypeFloat, picture.values);
        for (int c = 0; c < channels; ++c)
            if (spec.channelformat(c) == OIIO::TypeUInt32)
                read_values(input, c, c + 1, OIIO::TypeUInt32, picture.integers[spec.channel_name(c)]);
    } else if (spec.format == OIIO::TypeUInt8) {
        read_values(input, 0, channels, OIIO::TypeUInt8, picture.codes8);
    } else {
        read_values(input, 0, channels, OIIO::TypeUInt16, picture.codes16);
    }
}

Header header_of(const OIIO::ImageSpec& spec)
{
    return {.width = spec.width,
            .height = spec.height,
            .depth = spec.depth,
            .channels = spec.channelnames,
            .pixel_bytes = spec.pixel_bytes(true),
            .deep = spec.deep,
            .windows_differ = spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
                              spec.height != spec.full_height,
            .tile_width = spec.tile_width,
            .tile_height = spec.tile_height};
}

Picture decode_picture(std::span<const std::byte> bytes, Format format, const std::function<void(const Header&)>& check)
{
    OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(plugin(format));
    if (!input || !input->set_ioproxy(&memory)) throw lacks("read", format);
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    OIIO::ImageSpec spec;
    // A name of ours, never the file's: OpenImageIO reads meaning into names. The content comes from `memory`.
    if (!input->open("memory." + plugin(format), spec, config)) throw std::runtime_error(input->geterror());
    check(header_of(spec));

    Picture picture;
    picture.format = format;
    picture.width = spec.width;
    picture.height = spec.height;
    picture.channels = spec.channelnames;
    for (const OIIO::ParamValue& value : spec.extra_attribs)
        if (value.type() == OIIO::TypeString) picture.text[value.name().string()] = value.get_string();
    read_pixels(*input, picture);
    input->close();
    return picture;
}

OIIO::TypeDesc type_of(ChannelType type)
{
    switch (type) {
        case ChannelType::code8:
            return OIIO::TypeUInt8;
        case ChannelType::float32:
            return OIIO::TypeFloat;
        case ChannelType::uint32:
            return OIIO::TypeUInt32;
    }
    return OIIO::TypeUnknown;
}

std::vector<std::byte> encode_sheet(const Sheet& sheet)
{
    OIIO::ImageSpec spec(sheet.width, sheet.height, static_cast<int>(sheet.channels.size()), type_of(sheet.types[0]));
    if (sheet.format == Format::png) {
        spec.attribute("oiio:UnassociatedAlpha", 1);
        spec.attribute("oiio:ColorSpace", "sRGB");
    } else {
        spec.channelnames = sheet.channels;
        for (const ChannelType type : sheet.types) spec.channelformats.push_back(type_of(type));
        for (std::size_t c = 0; c < sheet.channels.size(); ++c)
            if (sheet.channels[c] == "A") spec.alpha_channel = static_cast<int>(c);
        spec.attribute("compression", "zip");
        spec.attribute("DateTime", "");  // else the writer says when it ran, and equal films differ in bytes
    }
    for (const auto& [key, value] : *sheet.text) spec.attribute(key, value);

    OIIO::Filesystem::IOVecOutput memory;
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(plugin(sheet.format));
    if (!output || !output->set_ioproxy(&memory)) throw lacks("write", sheet.format);
    // UNKNOWN: the data are in the file's own types already, channel by channel.
    if (!output->open("memory." + plugin(sheet.format), spec) || !output->write_image(OIIO::TypeUnknown, sheet.data) ||
        !output->close())
        throw std::runtime_error(output->geterror());
    const std::span<const std::byte> bytes = std::as_bytes(std::span(memory.buffer()));
    return {bytes.begin(), bytes.end()};
}

}  // namespace
}  // namespace etalon::codec

const etalon::codec::PictureLibrary* etalon_picture_library()
{
    static constexpr etalon::codec::PictureLibrary kLibrary{etalon::codec::decode_picture, etalon::codec::encode_sheet};
    return &kLibrary;
}
