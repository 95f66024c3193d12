#include <fmt/format.h>
#include <pentaprism/aov.h>
#include <pentaprism/error.h>

namespace pentaprism {
namespace {

std::vector<ChannelInfo> numbers(std::initializer_list<const char*> names) {
    std::vector<ChannelInfo> channels;
    for (const char* name : names) channels.push_back({name, false});
    return channels;
}

// CryptoObject00.r .g .b .a: two ranks of (id, coverage) in each layer.
std::vector<ChannelInfo> cryptomatte_channels() {
    std::vector<ChannelInfo> channels;
    for (const char* kind : {"CryptoObject", "CryptoMaterial"})
        for (int layer = 0; layer < kCryptomatteRanks / 2; ++layer)
            for (const char* letter : {"r", "g", "b", "a"})
                channels.push_back({fmt::format("{}{:02}.{}", kind, layer, letter), false});
    return channels;
}

}  // namespace

std::span<const AovInfo> aov_table() {
    static const std::vector<AovInfo> kTable{
        {Aov::kDepth, "depth", "mean distance along the optical axis, metres (Z is the closest sample's)",
         numbers({"depth.mean"})},
        {Aov::kNormal, "normal",
         "mean of the shading normals at mid-shutter on the side that is seen, world space; shorter than 1 where they "
         "differ",
         numbers({"N.X", "N.Y", "N.Z"})},
        {Aov::kPosition, "position", "mean place at mid-shutter of the points that are seen, world space, metres",
         numbers({"P.X", "P.Y", "P.Z"})},
        {Aov::kUv, "uv", "mean of the first texture coordinates, v down", numbers({"uv.u", "uv.v"})},
        {Aov::kMotion, "motion",
         "mean way on the screen of the points that are seen, to and from their place a frame later and earlier, "
         "pixels a frame, u to the right, v down, through the middle of the lens; points behind the camera then are "
         "left out",
         numbers({"forward.u", "forward.v", "backward.u", "backward.v"})},
        {Aov::kCoc, "coc",
         "mean signed radius of the circle of confusion at each sample's time, pixels, negative in front of the focus "
         "plane",
         numbers({"coc"})},
        {Aov::kTime, "time",
         "of the object that most samples see: first and last shutter time (0 to 1) of those samples, and their share "
         "of all",
         numbers({"time.first", "time.last", "time.blend"})},
        {Aov::kObjectId,
         "object-id",
         "the object that most samples see (attribute `objects` names them); 0 is the background, a tie takes the "
         "lower number",
         {{"id.object", true}}},
        {Aov::kMaterialId,
         "material-id",
         "the material that most samples see (attribute `materials` names them); 0 is the background, a tie takes the "
         "lower number",
         {{"id.material", true}}},
        {Aov::kCryptomatte, "cryptomatte",
         "ids of objects and materials (MurmurHash3 of their names) with the share of the samples that see them, best "
         "first",
         cryptomatte_channels()},
        {Aov::kCoverage, "coverage", "share of the samples that hit something", numbers({"coverage"})},
        {Aov::kVariance, "variance", "estimated variance of the mean of the pixel's samples, of linear colour",
         numbers({"variance.R", "variance.G", "variance.B"})},
        {Aov::kAlbedo, "albedo",
         "mean base colour of the points that are seen, linear: factor, vertex colour and texture at the very point of "
         "each sample, without light; of a metal the colour of its reflection",
         numbers({"Albedo.R", "Albedo.G", "Albedo.B"})},
        {Aov::kOcclusion, "occlusion",
         "shares of the samples that hit something whose point, at mid-shutter a frame later and earlier, is in the "
         "picture of a pinhole but hidden behind something, or outside of that picture; the rest is seen there, too",
         numbers({"forward.hidden", "forward.outside", "backward.hidden", "backward.outside"})},
        {Aov::kSte, "ste",
         "what the culling test costs: of the exact tests of the pixel's samples the share that is covered (0 where "
         "there was none), and their number",
         numbers({"ste", "ste.tested"})},
        {Aov::kSamples, "samples", "number of the pixel's samples: what --target-error gave it", numbers({"samples"})},
    };
    return kTable;
}

const AovInfo& aov_info(Aov aov) {
    return aov_table()[static_cast<std::size_t>(aov)];
}

Aov aov_named(std::string_view name) {
    std::string names;
    for (const AovInfo& info : aov_table()) {
        if (name == info.name) return info.aov;
        names += (names.empty() ? "" : ", ") + std::string(info.name);
    }
    throw Error(ErrorKind::kUsage, fmt::format("--aov: '{}' is not one of {}", name, names));
}

}  // namespace pentaprism
