#include "cull/cull_test.h"

namespace pentaprism {

const CullTest* find_cull_test(std::string_view name) {
    for (const CullTest* test : cull_table())
        if (name == test->name) return test;
    return nullptr;
}

}  // namespace pentaprism
