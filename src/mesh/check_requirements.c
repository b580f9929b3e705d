#include <string.h>

#include "base/error.h"
#include "hewn/check.h"

static const struct {
    hewn_requirement bit;
    const char *name;
} requirements[] = {
    {HEWN_REQUIRE_CLOSED, "closed"},
    {HEWN_REQUIRE_MANIFOLD, "manifold"},
    {HEWN_REQUIRE_ORIENTED, "oriented"},
    {HEWN_REQUIRE_NO_SELF_INTERSECTIONS, "no-self-intersections"},
    {HEWN_REQUIRE_NO_DEGENERATE_FACES, "no-degenerate-faces"},
    {HEWN_REQUIRE_NO_DUPLICATE_FACES, "no-duplicate-faces"},
    {HEWN_REQUIRE_NO_ISOLATED_VERTICES, "no-isolated-vertices"},
    {HEWN_REQUIRE_ONE_COMPONENT, "one-component"},
    {HEWN_REQUIRE_POSITIVE_VOLUME, "positive-volume"},
};

enum { COUNT = sizeof requirements / sizeof requirements[0] };

const char *hewn_requirement_name(hewn_requirement requirement)
{
    for (int i = 0; i < COUNT; i++)
        if (requirements[i].bit == requirement)
            return requirements[i].name;
    return NULL;
}

static uint32_t find_word(const char *word, size_t length)
{
    for (int i = 0; i < COUNT; i++)
        if (strlen(requirements[i].name) == length && memcmp(requirements[i].name, word, length) == 0)
            return requirements[i].bit;
    return 0;
}

static hewn_result refuse_word(const char *word, size_t length, hewn_error *error)
{
    char known[512] = "";
    for (int i = 0; i < COUNT; i++) {
        strcat(known, i > 0 ? ", " : "");
        strcat(known, requirements[i].name);
    }
    if (length == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "an empty word among the requirements; known are %s", known);
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "\"%.*s\" is no requirement; known are %s",
                     (int)(length < 100 ? length : 100), word, known);
}

hewn_result hewn_requirements_parse(const char *words, uint32_t *out, hewn_error *error)
{
    *out = 0;
    uint32_t bits = 0;
    for (const char *at = words ? words : "";; at++) {
        at += strspn(at, " \t");
        size_t whole = strcspn(at, ","), length = whole;
        while (length > 0 && strchr(" \t", at[length - 1]))
            length--;
        uint32_t bit = find_word(at, length);
        if (bit == 0)
            return refuse_word(at, length, error);
        bits |= bit;
        at += whole;
        if (*at == 0)
            break;
    }
    *out = bits;
    return HEWN_OK;
}

uint32_t hewn_check_unmet(const hewn_check *check, uint32_t required)
{
    const hewn_certificate *c = &check->certificate;
    uint32_t met = 0;
    met |= c->closed ? HEWN_REQUIRE_CLOSED : 0;
    met |= c->manifold ? HEWN_REQUIRE_MANIFOLD : 0;
    met |= c->oriented ? HEWN_REQUIRE_ORIENTED : 0;
    met |= check->self_intersections_known && check->self_intersections == 0 ? HEWN_REQUIRE_NO_SELF_INTERSECTIONS : 0;
    met |= c->degenerate_faces == 0 ? HEWN_REQUIRE_NO_DEGENERATE_FACES : 0;
    met |= check->duplicate_faces == 0 ? HEWN_REQUIRE_NO_DUPLICATE_FACES : 0;
    met |= check->isolated_vertices == 0 ? HEWN_REQUIRE_NO_ISOLATED_VERTICES : 0;
    met |= c->components == 1 ? HEWN_REQUIRE_ONE_COMPONENT : 0;
    met |= c->closed && c->oriented && c->volume > 0 ? HEWN_REQUIRE_POSITIVE_VOLUME : 0;
    return required & ~met;
}
