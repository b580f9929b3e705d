#include "app/certificate.h"

#include <inttypes.h>

/* Components and pairs that are listed for people; JSON has more. */
enum { LISTED_COMPONENTS = 12, LISTED_PAIRS = 4 };

static const char *yes(bool value)
{
    return value ? "yes" : "no";
}

static const char *plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}

static void print_count(FILE *file, const char *name, uint64_t count)
{
    fprintf(file, "%-22s %" PRIu64 "\n", name, count);
}

static void print_crossings(const hewn_check *check, FILE *file)
{
    uint64_t shown = check->pair_count < LISTED_PAIRS ? check->pair_count : LISTED_PAIRS;
    if (!check->self_intersections_known) {
        fprintf(file, "%-22s not counted\n", "self-intersections");
        return;
    }
    fprintf(file, "%-22s %" PRIu64, "self-intersections", check->self_intersections);
    for (uint64_t i = 0; i < shown; i++) {
        const uint32_t *pair = check->pairs[i];
        fprintf(file, "%s", i == 0 ? " (faces " : ", ");
        if (pair[0] == pair[1])
            fprintf(file, "%u by itself", pair[0]);
        else
            fprintf(file, "%u and %u", pair[0], pair[1]);
    }
    if (shown > 0)
        fprintf(file, "%s)", check->self_intersections > shown ? ", ..." : "");
    fputc('\n', file);
}

static void print_components(const hewn_check *check, FILE *file)
{
    uint64_t all = check->certificate.components;
    uint32_t shown = check->component_count < LISTED_COMPONENTS ? check->component_count : LISTED_COMPONENTS;
    if (all < 2)
        return;
    fprintf(file, "%10s %10s %7s %9s %9s %6s %6s %13s %13s\n", "faces", "vertices", "closed", "manifold", "oriented",
            "genus", "loops", "volume", "area");
    for (uint32_t i = 0; i < shown; i++) {
        const hewn_component *part = &check->components[i];
        fprintf(file, "%10" PRIu64 " %10" PRIu64 " %7s %9s %9s", part->faces, part->vertices, yes(part->closed),
                yes(part->manifold), yes(part->oriented));
        if (part->genus >= 0)
            fprintf(file, " %6" PRId64, part->genus);
        else
            fprintf(file, " %6s", "-");
        fprintf(file, " %6" PRIu64, part->boundary_loops);
        if (part->closed && part->oriented)
            fprintf(file, " %13.6g", part->volume);
        else
            fprintf(file, " %13s", "-");
        fprintf(file, " %13.6g\n", part->area);
    }
    if (all > shown)
        fprintf(file, "%10s and %" PRIu64 " smaller one%s\n", "", all - shown, plural(all - shown));
}

void hewn_certificate_print(const hewn_check *check, FILE *file)
{
    const hewn_certificate *c = &check->certificate;
    fprintf(file, "%-22s %s\n", "closed", yes(c->closed));
    fprintf(file, "%-22s %s\n", "manifold", yes(c->manifold));
    fprintf(file, "%-22s %s%s\n", "oriented", yes(c->oriented),
            c->oriented         ? ""
            : check->orientable ? ", but it can be"
                                : ", and it cannot be: it is one-sided");
    print_count(file, "components", c->components);
    if (c->genus >= 0)
        fprintf(file, "%-22s %" PRId64 "\n", "genus", c->genus);
    fprintf(file, "%-22s %" PRId64 "\n", "Euler characteristic", check->euler);
    if (c->closed && c->oriented)
        fprintf(file, "%-22s %.9g%s\n", "volume", c->volume, c->volume < 0 ? " (inside out)" : "");
    fprintf(file, "%-22s %.9g\n", "area", c->area);
    fprintf(file, "%-22s %.9g,%.9g,%.9g to %.9g,%.9g,%.9g\n", "bounds", c->bounds.lo[0], c->bounds.lo[1],
            c->bounds.lo[2], c->bounds.hi[0], c->bounds.hi[1], c->bounds.hi[2]);
    fprintf(file, "%-22s %" PRIu64 "%s", "boundary edges", c->boundary_edges, c->boundary_edges > 0 ? "" : "\n");
    if (c->boundary_edges > 0)
        fprintf(file, " in %" PRIu64 " loop%s\n", check->boundary_loops, plural(check->boundary_loops));
    print_count(file, "non-manifold edges", c->non_manifold_edges);
    print_count(file, "non-manifold vertices", c->non_manifold_vertices);
    if (!c->oriented)
        print_count(file, "unoriented edges", check->unoriented_edges);
    print_count(file, "degenerate faces", c->degenerate_faces);
    print_count(file, "duplicate faces", check->duplicate_faces);
    print_count(file, "isolated vertices", check->isolated_vertices);
    print_crossings(check, file);
    print_components(check, file);
}

void hewn_certificate_summarise(const hewn_check *check, const hewn_unit *unit, FILE *file)
{
    const hewn_certificate *c = &check->certificate;
    const char *space = unit ? " " : "", *name = unit ? unit->name : "";
    fprintf(file, "  %s, %s, %s", c->closed ? "closed" : "open", c->manifold ? "manifold" : "not manifold",
            c->oriented ? "oriented" : "not oriented");
    if (check->self_intersections_known && check->self_intersections == 0)
        fprintf(file, ", no self-intersections");
    else if (check->self_intersections_known)
        fprintf(file, ", %" PRIu64 " self-intersection%s", check->self_intersections,
                plural(check->self_intersections));
    if (c->boundary_edges > 0)
        fprintf(file, ", %" PRIu64 " boundary loop%s of %" PRIu64 " edges", check->boundary_loops,
                plural(check->boundary_loops), c->boundary_edges);
    fprintf(file, "\n  %" PRIu64 " component%s", c->components, plural(c->components));
    if (c->genus >= 0)
        fprintf(file, ", genus %" PRId64, c->genus);
    if (c->closed && c->oriented)
        fprintf(file, ", volume %.6g%s%s%s%s", c->volume, space, name, unit ? "³" : "",
                c->volume < 0 ? " (inside out)" : "");
    fprintf(file, ", area %.6g%s%s%s\n", c->area, space, name, unit ? "²" : "");
}

void hewn_certificate_explain(const hewn_check *check, hewn_requirement requirement, FILE *file)
{
    const hewn_certificate *c = &check->certificate;
    switch (requirement) {
    case HEWN_REQUIRE_CLOSED: fprintf(file, "%" PRIu64 " boundary edges", c->boundary_edges); break;
    case HEWN_REQUIRE_MANIFOLD:
        fprintf(file, "%" PRIu64 " non-manifold edges, %" PRIu64 " non-manifold vertices", c->non_manifold_edges,
                c->non_manifold_vertices);
        break;
    case HEWN_REQUIRE_ORIENTED: fprintf(file, "%" PRIu64 " unoriented edges", check->unoriented_edges); break;
    case HEWN_REQUIRE_NO_SELF_INTERSECTIONS:
        if (check->self_intersections_known)
            fprintf(file, "%" PRIu64 " self-intersections", check->self_intersections);
        else
            fputs("they were not counted", file);
        break;
    case HEWN_REQUIRE_NO_DEGENERATE_FACES: fprintf(file, "%" PRIu64 " degenerate faces", c->degenerate_faces); break;
    case HEWN_REQUIRE_NO_DUPLICATE_FACES: fprintf(file, "%" PRIu64 " duplicate faces", check->duplicate_faces); break;
    case HEWN_REQUIRE_NO_ISOLATED_VERTICES:
        fprintf(file, "%" PRIu64 " isolated vertices", check->isolated_vertices);
        break;
    case HEWN_REQUIRE_ONE_COMPONENT: fprintf(file, "%" PRIu64 " components", c->components); break;
    case HEWN_REQUIRE_POSITIVE_VOLUME:
        if (c->closed && c->oriented)
            fprintf(file, "a volume of %g", c->volume);
        else
            fputs("no volume, being open or not oriented", file);
        break;
    case HEWN_REQUIRE_ALL: break;
    }
}
