/* Code for places along one axis. A part of the field that depends on one variable only is the same for all of them,
 * unless the variable is that axis's: so the parts of the other two axes are evaluated once and kept. Which axis that
 * is differs from invocation to invocation, and a CPU device runs all arms of a branch; so there is one function of one
 * number for the parts of all three axes, which pays where these are the same functions, as they are in fields that
 * treat the axes alike. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "eval/listing.h"

/* Longer listings are not looked through: each part is compared with all others. */
enum { MOST_STEPS = 4096 };

enum { ALL = HEWN_AXIS_X | HEWN_AXIS_Y | HEWN_AXIS_Z };

/* Values that a walk asks for; and parts are made where the cost with them is less than so many fifths of that without.
 */
enum { PLACES = 5, SHARE_OF_FIVE = 4, A_CHOICE = 2 };

static bool depends_on_one(const hewn_code_step *step)
{
    return step->axes == HEWN_AXIS_X || step->axes == HEWN_AXIS_Y || step->axes == HEWN_AXIS_Z;
}

static bool is_part(const hewn_code_step *step)
{
    return step->part;
}

static bool depends_on_several(const hewn_code_step *step)
{
    return !depends_on_one(step);
}

/* --- which functions are the same --------------------------------------------------------------------------------- */

static bool are_alike(const hewn_listing *listing, uint32_t a, uint32_t b)
{
    const hewn_code_step *one = &listing->steps[a], *other = &listing->steps[b];
    if (one->op <= HEWN_OP_Z || other->op <= HEWN_OP_Z)
        return one->op <= HEWN_OP_Z && other->op <= HEWN_OP_Z;
    bool alike = one->op == other->op && one->in_count == other->in_count && one->sure == other->sure &&
                 one->parameter_count == other->parameter_count;
    for (uint32_t i = 0; alike && i < one->parameter_count; i++)
        alike = listing->parameters[one->parameter + i] == listing->parameters[other->parameter + i];
    if (one->op == HEWN_OP_CONSTANT || !alike)
        return alike;
    if (!one->function || !other->function || hewn_listing_has_address(one) ||
        strcmp(one->function, other->function) != 0)
        return false;
    for (uint32_t i = 0; i < one->in_count; i++) {
        const hewn_code_step *in[2] = {&listing->steps[one->in[i]], &listing->steps[other->in[i]]};
        bool parts = depends_on_one(in[0]) && depends_on_one(in[1]) && in[0]->function && in[1]->function;
        if (parts ? in[0]->same != in[1]->same : !are_alike(listing, one->in[i], other->in[i]))
            return false;
    }
    return true;
}

/* Axis by axis, so that what a function is made of stands beside it. */
static void find_same(hewn_listing *listing, uint32_t *firsts)
{
    uint32_t count = 0;
    for (uint32_t axis = HEWN_AXIS_X; axis <= HEWN_AXIS_Z; axis *= 2)
        for (uint32_t i = 0; i < listing->count; i++) {
            hewn_code_step *step = &listing->steps[i];
            if (step->axes != axis || !step->function)
                continue;
            uint32_t at = 0;
            while (at < count && !are_alike(listing, firsts[at], i))
                at++;
            if (at == count)
                firsts[count++] = i;
            step->same = firsts[at];
        }
}

static void mark(hewn_listing *listing)
{
    hewn_code_step *steps = listing->steps;
    for (size_t i = 0; i < listing->count; i++)
        for (uint32_t k = 0; k < steps[i].in_count && depends_on_several(&steps[i]); k++) {
            hewn_code_step *in = &steps[steps[i].in[k]];
            in->shown = in->function && depends_on_one(in);
        }
    hewn_code_step *root = &steps[listing->count - 1];
    root->shown = root->function && depends_on_one(root);
    for (size_t i = 0; i < listing->count; i++)
        if (steps[i].shown)
            steps[steps[i].same].part = true;
    for (size_t i = listing->count; i-- > 0;)
        for (uint32_t k = 0; k < steps[i].in_count && steps[i].part; k++)
            steps[steps[i].in[k]].part = steps[steps[i].in[k]].function != NULL;
}

static bool parts_pay(const hewn_listing *listing)
{
    uint64_t parts = 0, all = 0, several = 0, choices = 0;
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        uint32_t weight = hewn_listing_weight(step);
        all += weight;
        parts += step->part ? weight : 0;
        several += depends_on_several(step) ? weight : 0;
        choices += step->shown ? A_CHOICE : 0;
    }
    return 5 * (2 * parts + PLACES * (parts + choices + several)) < (uint64_t)SHARE_OF_FIVE * PLACES * all;
}

hewn_result hewn_listing_part(hewn_listing *listing, hewn_error *error)
{
    if (listing->count == 0 || listing->count > MOST_STEPS)
        return HEWN_OK;
    uint32_t *firsts = hewn_alloc(listing->count, sizeof *firsts);
    if (!firsts)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the parts of %zu operations", listing->count);
    find_same(listing, firsts);
    hewn_free(firsts);
    mark(listing);
    listing->parted = parts_pay(listing);
    return HEWN_OK;
}

/* --- text -------------------------------------------------------------------------------------------------------- */

static unsigned axis_of(const hewn_code_step *step)
{
    return step->axes == HEWN_AXIS_X ? 0 : step->axes == HEWN_AXIS_Y ? 1 : 2;
}

/* Text for each shown step that depends on one of the axes: with @ its number, # that of its part, $ its axis. */
static void write_each(const hewn_listing *listing, uint32_t axes, const char *form, hewn_text *text)
{
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        for (const char *at = form; *at && step->shown && (step->axes & axes); at++)
            if (*at == '@')
                hewn_text_print(text, "%zu", i);
            else if (*at == '#')
                hewn_text_print(text, "%u", step->same);
            else if (*at == '$')
                hewn_text_print(text, "%uu", axis_of(step));
            else
                hewn_text_append_bytes(text, at, 1);
    }
}

/* `now`: the parts where they were evaluated last; several shown steps may have the same. */
static void write_parts(const hewn_listing *listing, bool slopes, hewn_text *text)
{
    for (size_t i = 0; i < listing->count; i++) {
        bool first = false;
        for (size_t k = 0; k < listing->count && !first && listing->steps[i].part; k++)
            first = listing->steps[k].shown && listing->steps[k].same == i;
        if (first)
            hewn_text_print(text, slopes ? "vec2 f_slope_now%zu;\n" : "float f_now%zu;\n", i);
    }
    hewn_text_append(text, slopes ? "void field_slope_parts(float at)\n{\nvec4 x=vec4(1.0,0.0,0.0,at),y=x,z=x;\n"
                                  : "void field_parts(float at)\n{\nfloat x=at,y=at,z=at;\n");
    hewn_listing_write_steps(listing, slopes ? HEWN_LISTING_GRADIENT : HEWN_LISTING_POINT, is_part, text);
    write_each(listing, ALL, slopes ? "f_slope_now#=n#.xw;\n" : "f_now#=n#;\n", text);
    hewn_text_append(text, "}\n");
}

/* Parts of the other two axes are kept with their slopes. */
static void write_values(const hewn_listing *listing, hewn_text *text)
{
    write_each(listing, ALL, "vec2 f_kept@;\n", text);
    hewn_text_append(text, "void field_stand(vec3 start, uint axis)\n{\nf_start=start;\nf_axis=axis;\n"
                           "uint one=axis==2u?0u:axis+1u,other=axis==0u?2u:axis-1u;\nfield_slope_parts(start[one]);\n");
    write_each(listing, ALL, "f_kept@=f_slope_now#;\n", text);
    hewn_text_append(text, "field_slope_parts(start[other]);\n");
    write_each(listing, ALL, "f_kept@=mix(f_kept@,f_slope_now#,bvec2(other==$));\n", text);
    hewn_text_append(text, "}\nfloat field_along(float at)\n{\nfield_parts(at);\n"
                           "float x=f_pick(f_axis==0u,at,f_start.x),y=f_pick(f_axis==1u,at,f_start.y),"
                           "z=f_pick(f_axis==2u,at,f_start.z);\n");
    write_each(listing, ALL, "float n@=f_pick(f_axis==$,f_now#,f_kept@.y);\n", text);
    hewn_listing_write_steps(listing, HEWN_LISTING_POINT, depends_on_several, text);
    hewn_text_append(text, "return ");
    hewn_listing_write_root(listing, HEWN_LISTING_POINT, text);
    hewn_text_append(text, ";\n}\n");
}

/* Derivatives of parts are along their own axis only, so the rest of what the rules of gradients compute is unused. */
static void write_slopes(const hewn_listing *listing, hewn_text *text)
{
    hewn_text_append(text, "vec4 field_slope_along(float at)\n{\nvec3 place=f_start;\nplace[f_axis]=at;\n"
                           "vec4 x=vec4(1.0,0.0,0.0,place.x),y=vec4(0.0,1.0,0.0,place.y),z=vec4(0.0,0.0,1.0,place.z);\n"
                           "field_slope_parts(at);\n");
    write_each(listing, ALL, "vec2 s@=mix(f_kept@,f_slope_now#,bvec2(f_axis==$));\n", text);
    write_each(listing, HEWN_AXIS_X, "vec4 n@=vec4(s@.x,0.0,0.0,s@.y);\n", text);
    write_each(listing, HEWN_AXIS_Y, "vec4 n@=vec4(0.0,s@.x,0.0,s@.y);\n", text);
    write_each(listing, HEWN_AXIS_Z, "vec4 n@=vec4(0.0,0.0,s@.x,s@.y);\n", text);
    hewn_listing_write_steps(listing, HEWN_LISTING_GRADIENT, depends_on_several, text);
    hewn_text_append(text, "return ");
    hewn_listing_write_root(listing, HEWN_LISTING_GRADIENT, text);
    hewn_text_append(text, ";\n}\n");
}

void hewn_listing_write_along(const hewn_listing *listing, hewn_text *text)
{
    hewn_text_append(text, "vec3 f_start;\nuint f_axis;\n");
    if (listing->parted) {
        write_parts(listing, false, text);
        write_parts(listing, true, text);
        write_values(listing, text);
        write_slopes(listing, text);
        return;
    }
    hewn_text_append(text, "void field_stand(vec3 start, uint axis)\n{\nf_start=start;\nf_axis=axis;\n}\n"
                           "float field_along(float at)\n{\nvec3 place=f_start;\nplace[f_axis]=at;\n"
                           "return field_point(place.x,place.y,place.z);\n}\n"
                           "vec4 field_slope_along(float at)\n{\nvec3 place=f_start;\nplace[f_axis]=at;\n"
                           "return field_gradient(place.x,place.y,place.z);\n}\n");
}
