#include <cstdio>

int main() {
    std::puts("pentaprism");
    return 0;
}
