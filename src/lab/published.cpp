// Figures that papers printed, beside which ours are set. Sources:
//   Laine & Karras 2011, Improved Dual-Space Bounds for Simultaneous Motion and Defocus Blur (NVR-2011-004), table 1
//   Wu 2013, Clip Space Sample Culling for Stochastic Rasterization (thesis), tables 4.1 and 4.2; the same figures
//   stand
//     in table 1 of the journal version (Wu, Way, Tsai, Shih). 1024x768, 16 samples per pixel, GeForce GTX 580
//   McGuire, Enderton, Shirley, Luebke 2010, Real-Time Stochastic Rasterization on Conventional GPU Architectures,
//     table 1, given there in frames per second with shading. 1920x1080, GeForce GTX 280

#include <pentaprism/bench.h>

namespace pentaprism {
namespace {

constexpr const char* kLaine = "Laine & Karras 2011";
constexpr const char* kWu = "Wu 2013";
constexpr const char* kMcGuire = "McGuire et al. 2010";

// One row of a table with three methods: STE in percent and milliseconds.
struct Triple {
    const char *scene, *effect;
    double ste[3], milliseconds[3];
};

constexpr Triple kWuRows[] = {
    {"hand", "defocus", {12, 29, 29}, {135, 131, 123}},      {"hand", "defocus-x2", {10, 28, 27}, {140, 133, 126}},
    {"car", "motion", {9, 28, 27}, {178, 156, 158}},         {"car", "motion-x2", {4, 25, 26}, {185, 172, 166}},
    {"dragonfly", "motion", {3, 23, 22}, {156, 140, 136}},   {"dragonfly", "motion-x2", {1, 24, 24}, {161, 148, 138}},
    {"fairy-forest", "both", {0.4, 5, 19}, {212, 183, 175}}, {"fairy-forest", "both-x2", {0.2, 2, 13}, {222, 202, 188}},
};

constexpr Triple kLaineRows[] = {
    {"conan", "still", {23.6, 23.6, 23.6}, {}},     {"conan", "motion", {2.7, 23.7, 23.7}, {}},
    {"conan", "motion-x2", {1.3, 24.0, 24.0}, {}},  {"conan", "defocus", {1.7, 23.1, 23.6}, {}},
    {"conan", "defocus-x2", {0.7, 21.9, 23.5}, {}}, {"conan", "both", {0.7, 5.6, 23.7}, {}},
    {"conan", "both-x2", {0.4, 2.9, 23.7}, {}},
};

struct FramesPerSecond {
    const char *scene, *effect, *method;
    double value;
};
// 4 visibility samples and 1 shading sample per pixel. Bounds: hull for motion, box for defocus.
constexpr FramesPerSecond kMcGuireRows[] = {
    {"race", "motion", "hull", 36.2},         {"bridge", "motion", "hull", 4.8},
    {"fairy-forest", "motion", "hull", 15.5}, {"fairy-forest", "defocus", "bbox", 2.6},
    {"cubes", "defocus", "bbox", 59.2},
};

void add_triples(std::vector<PublishedFigure>& figures, const char* paper, const Triple& row,
                 const char* const theirs[3], const char* const ours[3]) {
    for (int i = 0; i < 3; ++i)
        figures.push_back(
            {paper, row.scene, row.effect, theirs[i], row.scene, ours[i], row.ste[i] / 100.0, row.milliseconds[i]});
}

}  // namespace

std::vector<PublishedFigure> published_figures() {
    std::vector<PublishedFigure> figures;
    for (const Triple& row : kWuRows)
        add_triples(figures, kWu, row, (const char* const[]){"Bbox", "Dual Space", "Our"},
                    (const char* const[]){"none", "dual-space", "clip-space"});
    for (const Triple& row : kLaineRows)
        add_triples(figures, kLaine, row, (const char* const[]){"Bbox scan", "[Laine et al. 2011]", "New method"},
                    (const char* const[]){"none", "dual-space", "improved-dual-space"});
    for (const FramesPerSecond& row : kMcGuireRows)
        figures.push_back({kMcGuire, row.scene, row.effect, row.method == std::string("hull") ? "2D hull" : "AABB",
                           row.scene, row.method == std::string("hull") ? "hull" : "none", 0.0, 1000.0 / row.value});
    return figures;
}

std::string published_difference(const std::string& scene) {
    const std::string models =
        " Our scenes are new ones that bear the names and the triangle counts of the literature: models, cameras and "
        "amounts "
        "of blur behind the printed figures are not to be had, so figures can agree in their tendency alone.";
    const std::string wu =
        " Wu's times are frames with shading at 1024x768 on a GeForce GTX 580; ours are visibility alone on this "
        "processor.";
    const std::string mcguire =
        " McGuire's are frames with shading and textures at 1920x1080 with 4 visibility samples a pixel on a GeForce "
        "GTX 280.";
    if (scene == "hand")
        return "Theirs has 15k triangles and focus depths of 0.5 and 0.3 in its own unit. Ours waves before the lights "
               "of a city, "
               "so that most covered samples lie far behind the focus." +
               wu + models;
    if (scene == "car")
        return "Theirs is one racing car with 54k triangles. Ours are two cars with turning wheels, and the camera "
               "pans along, "
               "so that road and stands move and the cars hardly do." +
               wu + models;
    if (scene == "dragonfly")
        return "Theirs (85k triangles) is blurred by the camera's motion. In ours the wings beat and the reeds sway, "
               "too." +
               wu + models;
    if (scene == "fairy-forest")
        return "Theirs is the Fairy Forest of 170k (Wu) or 174k (McGuire) triangles. Ours has as many in smaller and "
               "more "
               "scattered leaves and blades." +
               wu + mcguire + models;
    if (scene == "conan")
        return "The paper tells neither size, samples nor triangles of its scene CONAN. Ours is a character of about "
               "130k "
               "triangles." +
               models;
    if (scene == "race" || scene == "bridge" || scene == "cubes") return mcguire.substr(1) + models;
    return "";
}

}  // namespace pentaprism
