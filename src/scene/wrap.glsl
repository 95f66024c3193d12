// How a texture goes on beyond its edges: of scene/texture.cpp.

const int kRepeat = 0, kMirroredRepeat = 1, kClamp = 2;  // Wrap

int wrapped(int wrap, int i, int n) {
    if (wrap == kClamp) return clamp(i, 0, n - 1);
    int period = wrap == kRepeat ? n : 2 * n;
    i = (i + period) % period;  // i is at least -1
    return i < n ? i : period - 1 - i;
}

// Into one period.
float reduced(int wrap, float x) {
    if (wrap == kClamp) return x > 0.0 ? min(x, 1.0) : 0.0;
    if (!(abs(x) < 8388608.0)) return 0.0;
    precise float once = x - floor(x), twice = x - 2.0 * floor(0.5 * x);
    return wrap == kRepeat ? once : twice;
}
