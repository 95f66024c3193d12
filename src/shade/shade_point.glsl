// What the shading passes hand on: one side of one triangle in one pixel, and what each light that casts shadows adds.

struct ShadePoint {
    uint triangle, pixel;  // x | y << 16
    uint front;
    uint quarters;         // bit q: a sample sees it in quarter q of the shutter
    vec4 barycentrics;     // mean of the samples
    vec4 rest;             // colour without what follows
    vec4 position;         // relative to the eye, at mid-shutter; w: what a texel of a shadow map should measure there
};

const uint kNoShare = 0u, kOpenShare = 1u, kDoneShare = 2u;

// LitColor::Share
struct Share {
    vec3 color;
    uint state;
    vec3 offset;
    uint lit;  // bit of each map sample
};

const int kQuarters = 4, kLookups = 4, kShadowLanes = 16;

layout(std430, binding = 0) restrict buffer ShadePoints { ShadePoint shade_points[]; };

uniform uint first_point, point_count;  // of this dispatch

// Which thing of many this invocation is for; there are at most 65535 groups in a row.
uint item_index() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
}
