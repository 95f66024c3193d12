// OpenEXR 3.1 scan lines. Attributes follow ImfStandardAttributes.h, whose camera space is left-handed with +z forward
// and whose NDC runs from (0, 0) at the upper left to (1, 1) at the lower right of the display window.

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfFramesPerSecond.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <half.h>
#include <limits>
#include <new>
#include <optional>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>

#include "base/parallel.h"
#include "image/exr_stream.h"
#include "image/part_file.h"
#include "image/writers.h"

namespace pentaprism {
namespace {

constexpr float kHalfMax = 65504.0f;
constexpr int kLargestSide = 65536;

// A finite colour stays finite; infinity and not-a-number are kept, since hiding them would hide a mistake.
half to_half(float value) {
    return half(std::isfinite(value) ? std::clamp(value, -kHalfMax, kHalfMax) : value);
}

// OpenEXR multiplies row vectors (p * M): its rows are our columns, so the numbers lie in memory as ours do.
Imath::M44f to_m44f(const std::array<double, 16>& m) {
    Imath::M44f result;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) result[row][column] = static_cast<float>(m[4 * row + column]);
    }
    return result;
}

std::array<double, 16> to_forward_z(std::array<double, 16> world_to_camera) {
    for (int column = 0; column < 4; ++column) world_to_camera[4 * column + 2] *= -1.0;
    return world_to_camera;
}

std::array<double, 16> to_unit_ndc(std::array<double, 16> m) {
    for (int column = 0; column < 4; ++column) {
        double* c = &m[4 * column];
        c[0] = 0.5 * (c[0] + c[3]);
        c[1] = 0.5 * (c[3] - c[1]);
    }
    return m;
}

Imf::Header make_header(const FrameInfo& info, const FileMetadata& metadata) {
    const Imath::Box2i display({0, 0}, {info.width - 1, info.height - 1});
    const Imath::Box2i data({info.x0, info.y0}, {info.x1 - 1, info.y1 - 1});
    Imf::Header header(display, data, 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
    for (const char* name : {"R", "G", "B", "A"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));

    Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec. 709 with white at D65
    const double exposure = metadata.exposure_seconds > 0.0 ? metadata.exposure_seconds
                                                            : info.shutter_close - info.shutter_open - info.readout;
    Imf::addExpTime(header, static_cast<float>(exposure));
    if (info.lens_radius > 0.0) {  // a pinhole has neither
        Imf::addFocus(header, static_cast<float>(info.focus_distance));
        Imf::addAperture(header, static_cast<float>(info.fstop));
    }
    if (info.fps > 0.0) Imf::addFramesPerSecond(header, Imf::guessExactFps(info.fps));
    Imf::addWorldToCamera(header, to_m44f(to_forward_z(info.world_to_camera)));
    Imf::addWorldToNDC(header, to_m44f(to_unit_ndc(info.world_to_ndc)));
    header.insert("software", Imf::StringAttribute(metadata.software));
    header.insert("frame", Imf::DoubleAttribute(info.frame));
    if (!info.camera.empty()) header.insert("camera", Imf::StringAttribute(info.camera));
    if (!metadata.settings_json.empty()) header.insert("pentaprism", Imf::StringAttribute(metadata.settings_json));
    for (const auto& [name, value] : info.attributes) header.insert(name, Imf::StringAttribute(value));
    return header;
}

// The colour, then a part for each output variable, named after it and with its rule in words.
std::vector<Imf::Header> make_part_headers(const FrameInfo& info, const FileMetadata& metadata) {
    std::vector<Imf::Header> headers{make_header(info, metadata)};
    headers[0].setName("rgba");
    headers[0].setType(Imf::SCANLINEIMAGE);
    for (const Aov aov : info.aovs) {
        const AovInfo& about = aov_info(aov);
        Imf::Header header(headers[0].displayWindow(), headers[0].dataWindow(), 1.0f, Imath::V2f(0, 0), 1.0f,
                           Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
        header.setName(about.name);
        header.setType(Imf::SCANLINEIMAGE);
        Imf::addChromaticities(header, Imf::Chromaticities());  // parts have to agree
        header.insert("rule", Imf::StringAttribute(about.rule));
        for (const ChannelInfo& channel : about.channels)
            header.channels().insert(channel.name, Imf::Channel(channel.whole_number ? Imf::UINT : Imf::FLOAT));
        headers.push_back(header);
    }
    return headers;
}

class ExrWriter : public PictureWriter {
  public:
    ExrWriter(const std::filesystem::path& file, const FileMetadata& metadata)
        : metadata_(metadata), file_(file), stream_(file_) {}

    void begin(const FrameInfo& info) override {
        order_.begin(info, file_.name());
        x0_ = info.x0;
        aovs_ = info.aovs;
        guarded([&] {
            if (aovs_.empty()) {
                output_.emplace(stream_, make_header(info, metadata_));
            } else {
                const std::vector<Imf::Header> headers = make_part_headers(info, metadata_);
                parts_.emplace(stream_, headers.data(), static_cast<int>(headers.size()));
            }
        });
    }

    void rows(const PixelRows& band) override {
        order_.take(band);
        if (band.count == 0) return;
        to_halves(band);
        guarded([&] {
            if (aovs_.empty()) {
                output_->setFrameBuffer(frame_buffer(band));
                output_->writePixels(band.count);
            } else {
                write_parts(band);
            }
        });
    }

    void finish() override {
        order_.finish();
        output_.reset();  // writes the table of line offsets, and is silent about failures
        parts_.reset();
        file_.throw_if_failed();
        file_.commit();
    }

  private:
    // OpenEXR wraps what a stream throws into exceptions of its own, so the file is asked first.
    template <class Body>
    void guarded(const Body& body) {
        try {
            body();
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& error) {
            file_.throw_if_failed();
            throw Error(ErrorKind::kOutput, fmt::format("{}: cannot write ({})", file_.name().string(), error.what()));
        }
    }

    void to_halves(const PixelRows& band) {
        const auto row = static_cast<std::size_t>(4 * band.width);
        halves_.resize(row * static_cast<std::size_t>(band.count));
        parallel_ranges(static_cast<std::size_t>(band.count), 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin * row; i < end * row; ++i) halves_[i] = to_half(band.rgba[i]);
        });
    }

    Imf::FrameBuffer frame_buffer(const PixelRows& band) {
        const Imath::V2i origin(x0_, band.y0);
        const std::size_t pixel = 4 * sizeof(half);
        Imf::FrameBuffer buffer;
        const std::array<const char*, 4> names{"R", "G", "B", "A"};
        for (std::size_t i = 0; i < names.size(); ++i) {
            buffer.insert(names[i], Imf::Slice::Make(Imf::HALF, halves_.data() + i, origin, band.width, band.count,
                                                     pixel, pixel * static_cast<std::size_t>(band.width)));
        }
        buffer.insert("Z", Imf::Slice::Make(Imf::FLOAT, band.z.data(), origin, band.width, band.count));
        return buffer;
    }

    void write_parts(const PixelRows& band) {
        const auto write = [&](int part, const Imf::FrameBuffer& buffer) {
            Imf::OutputPart output(*parts_, part);
            output.setFrameBuffer(buffer);
            output.writePixels(band.count);
        };
        write(0, frame_buffer(band));
        const Imath::V2i origin(x0_, band.y0);
        const auto pixels = static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.count);
        const float* channel = band.aovs.data();
        for (std::size_t i = 0; i < aovs_.size(); ++i) {
            Imf::FrameBuffer buffer;
            for (const ChannelInfo& about : aov_info(aovs_[i]).channels) {
                buffer.insert(about.name, Imf::Slice::Make(about.whole_number ? Imf::UINT : Imf::FLOAT, channel, origin,
                                                           band.width, band.count));
                channel += pixels;
            }
            write(static_cast<int>(i) + 1, buffer);
        }
    }

    FileMetadata metadata_;
    RowOrder order_;
    int x0_ = 0;
    std::vector<Aov> aovs_;
    std::vector<half> halves_;
    // Destroyed last to first: the output writes into the stream, the stream into the file.
    PartFile file_;
    PartStream stream_;
    std::optional<Imf::OutputFile> output_;          // of a picture of colour and depth alone
    std::optional<Imf::MultiPartOutputFile> parts_;  // of one with more
};

void read_channels(Imf::InputFile& input, Picture& picture) {
    const Imath::Box2i& data = input.header().dataWindow();
    const Imf::ChannelList& channels = input.header().channels();
    const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    picture.rgba.resize(4 * pixels);
    picture.z.resize(pixels);
    Imf::FrameBuffer buffer;
    const std::array<const char*, 4> names{"R", "G", "B", "A"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i < 3 && !channels.findChannel(names[i])) {
            throw std::runtime_error(fmt::format("it has no channel {}", names[i]));
        }
        buffer.insert(names[i],
                      Imf::Slice::Make(Imf::FLOAT, picture.rgba.data() + i, data, 4 * sizeof(float), 0, 1, 1, 1.0));
    }
    buffer.insert("Z", Imf::Slice::Make(Imf::FLOAT, picture.z.data(), data, sizeof(float), 0, 1, 1,
                                        std::numeric_limits<float>::infinity()));
    input.setFrameBuffer(buffer);
    input.readPixels(data.min.y, data.max.y);
}

void read_info(const Imf::Header& header, FrameInfo& info) {
    const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
    info.width = display.max.x - display.min.x + 1;
    info.height = display.max.y - display.min.y + 1;
    info.x0 = data.min.x;
    info.y0 = data.min.y;
    info.x1 = data.max.x + 1;
    info.y1 = data.max.y + 1;
    if (Imf::hasFocus(header)) info.focus_distance = Imf::focus(header);
    if (Imf::hasAperture(header)) info.fstop = Imf::aperture(header);
    if (Imf::hasExpTime(header)) info.shutter_close = Imf::expTime(header);
    if (Imf::hasFramesPerSecond(header)) info.fps = static_cast<double>(Imf::framesPerSecond(header));
    if (const auto* frame = header.findTypedAttribute<Imf::DoubleAttribute>("frame")) info.frame = frame->value();
    if (const auto* camera = header.findTypedAttribute<Imf::StringAttribute>("camera")) info.camera = camera->value();
}

}  // namespace

std::unique_ptr<PictureWriter> make_exr_writer(const std::filesystem::path& file, const FileMetadata& metadata) {
    return std::make_unique<ExrWriter>(file, metadata);
}

Picture read_exr(const std::filesystem::path& file) {
    try {
        Imf::InputFile input(file.c_str());
        const Imath::Box2i& data = input.header().dataWindow();
        const auto width = static_cast<std::int64_t>(data.max.x) - data.min.x + 1;
        const auto height = static_cast<std::int64_t>(data.max.y) - data.min.y + 1;
        if (width > kLargestSide || height > kLargestSide) {
            throw std::runtime_error(fmt::format("{}x{} pixels are too many", width, height));
        }
        Picture picture;
        picture.width = static_cast<int>(width);
        picture.height = static_cast<int>(height);
        read_info(input.header(), picture.info);
        read_channels(input, picture);
        return picture;
    } catch (const std::exception& error) {
        throw Error(ErrorKind::kScene, fmt::format("{}: cannot read ({})", file.string(), error.what()));
    }
}

FileMetadata read_exr_metadata(const std::filesystem::path& file) {
    try {
        const Imf::InputFile input(file.c_str());
        const auto text = [&](const char* name) {
            const auto* attribute = input.header().findTypedAttribute<Imf::StringAttribute>(name);
            return attribute ? attribute->value() : std::string();
        };
        FileMetadata metadata;
        metadata.settings_json = text("pentaprism");
        metadata.software = text("software");
        return metadata;
    } catch (const std::exception& error) {
        throw Error(ErrorKind::kScene, fmt::format("{}: cannot read ({})", file.string(), error.what()));
    }
}

void set_picture_threads(int threads) {
    Imf::setGlobalThreadCount(std::max(0, threads));
}

}  // namespace pentaprism
