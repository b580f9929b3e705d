/* GLSL only: the point of a cell that is nearest to a few planes in the sense of least squares, after Ju, Losasso,
 * Schaefer and Warren 2002 ('Dual contouring of Hermite data').
 *
 * All is in units of cells, from the cell's lowest corner, so that no digits are spent on where the cell is. Planes are
 * taken about the mean of the crossings (the mass point). Directions in which the planes say too little are left out
 * (the least singular values are cut off), and among the points that are equally good the one nearest to the mass point
 * is taken. Where the best point is not in the box it is the best one of the box, exactly: not the nearest one to the
 * best. What is not a number is never added, so the result is always a point of the box.
 *
 * A kernel has one set of planes, since arrays that are passed around are copied. */
#ifndef HEWN_SHADERS_ISO_QEF_H
#define HEWN_SHADERS_ISO_QEF_H

#define QEF_MOST 18u

/* A direction counts where its singular value is at least this share of the greatest one. Two flat pieces with as many
 * crossings each give tan(a / 2), a the angle between their normals: edges blunter than 174 degrees are taken as
 * smooth. docs/extraction.md has what was measured. */
const float QEF_CUT = 0.05;
/* What remains after the cut is 0 but for rounding where it is below this share. */
const float QEF_NOISE = 1.0e-5;
/* What nearness to the mass point weighs beside the planes: a cell of distance as much as 3e-5 cells off a plane. */
const float QEF_NEAR = 1.0e-9;

vec4 qef_planes[QEF_MOST]; /* unit normal, and its product with the plane's points */
uint qef_count;
uint qef_taken;  /* a bit for each plane that counts */
vec4 qef_points; /* sum of the crossings, and how many */

struct Qef {
    vec3 at;
    vec3 best; /* the best point anywhere */
    uint rank; /* directions that count: 1 in smooth places, 2 at edges, 3 at corners */
    vec3 free; /* where the rank is 2, the direction of the edge */
};

bool qef_finite(vec3 v)
{
    return all(lessThanEqual(abs(v), vec3(1.0e30)));
}

void qef_begin()
{
    qef_count = 0u;
    qef_taken = 0xFFFFFFFFu;
    qef_points = vec4(0.0);
}

/* Planes beyond the most that are held are not taken; nor are normals that are no directions. */
void qef_add_plane(vec3 point, vec3 normal)
{
    float size = length(normal);
    if (qef_finite(point) && size > 1.0e-20 && size < 1.0e20 && qef_count < QEF_MOST) {
        vec3 unit = normal / size;
        qef_planes[qef_count] = vec4(unit, dot(unit, point));
        qef_count++;
    }
}

void qef_add_crossing(vec3 point, vec3 normal)
{
    qef_points += qef_finite(point) ? vec4(point, 1.0) : vec4(0.0);
    qef_add_plane(point, normal);
}

/* The mean of the crossings, kept in the box; its middle where there are none. */
vec3 qef_mass_point(vec3 lo, vec3 hi)
{
    vec3 mean = qef_points.w > 0.0 ? qef_points.xyz / qef_points.w : 0.5 * (lo + hi);
    return clamp(mean, lo, hi);
}

/* One Jacobi rotation of a symmetric matrix: takes `between` to 0. p and q are its diagonal entries, rp and rq those
 * that the third row has with them, and vp and vq the columns of the basis. */
void qef_rotate(inout float p, inout float q, inout float between, inout float rp, inout float rq, inout vec3 vp,
                inout vec3 vq)
{
    float ratio = 0.5 * (q - p) / between;
    float tangent = (ratio < 0.0 ? -1.0 : 1.0) / (abs(ratio) + sqrt(ratio * ratio + 1.0));
    tangent = abs(between) > 1.0e-30 ? tangent : 0.0;
    float cosine = inversesqrt(1.0 + tangent * tangent), sine = tangent * cosine;
    p -= tangent * between;
    q += tangent * between;
    between = 0.0;
    vec2 row = vec2(rp, rq);
    rp = cosine * row.x - sine * row.y;
    rq = sine * row.x + cosine * row.y;
    vec3 first = vp;
    vp = cosine * first - sine * vq;
    vq = sine * first + cosine * vq;
}

/* Directions in which the planes' normals vary independently: eigenvectors of the sum of their squares. */
mat3 qef_directions()
{
    vec3 diagonal = vec3(0.0), beside = vec3(0.0); /* of the second: y z, x z, x y */
    for (uint i = 0u; i < qef_count; i++) {
        vec3 n = (qef_taken >> i & 1u) != 0u ? qef_planes[i].xyz : vec3(0.0);
        diagonal += n * n;
        beside += n.yxx * n.zzy;
    }
    vec3 x = vec3(1.0, 0.0, 0.0), y = vec3(0.0, 1.0, 0.0), z = vec3(0.0, 0.0, 1.0);
    for (uint sweep = 0u; sweep < 5u; sweep++) {
        qef_rotate(diagonal.x, diagonal.y, beside.z, beside.y, beside.x, x, y);
        qef_rotate(diagonal.x, diagonal.z, beside.y, beside.z, beside.x, x, z);
        qef_rotate(diagonal.y, diagonal.z, beside.x, beside.z, beside.y, y, z);
    }
    return mat3(x, y, z);
}

/* The best point of the box for the error |root (x - best)|^2, if best lies outside it: the best one of each face, edge
 * and corner, in so far as it lies there, is tried. `root` has a row for each direction, so its columns belong to the
 * axes, and fixing a coordinate takes a column out. */
vec3 qef_on_box(mat3 root, vec3 best, vec3 mass, vec3 lo, vec3 hi)
{
    float most = max(max(dot(root[0], root[0]), dot(root[1], root[1])), dot(root[2], root[2]));
    float noise = QEF_NOISE * QEF_NOISE * most;
    vec3 found = mass;
    float least = 3.0e38;
    for (uint place = 1u; place < 27u; place++) {
        uvec3 side = uvec3(place % 3u, place / 3u % 3u, place / 9u); /* 0: anywhere between, 1: low, 2: high */
        bvec3 open = equal(side, uvec3(0u));
        vec3 from = mix(mix(lo, hi, equal(side, uvec3(2u))), mass, open);
        vec3 rest = root * (best - from);
        vec3 columns[3];
        for (uint i = 0u; i < 3u; i++)
            columns[i] = open[i] ? root[i] : vec3(0.0);
        vec3 sizes = vec3(dot(columns[0], columns[0]), dot(columns[1], columns[1]), dot(columns[2], columns[2]));
        uint first = sizes.x >= sizes.y && sizes.x >= sizes.z ? 0u : sizes.y >= sizes.z ? 1u : 2u;
        uint second = (first + 1u) % 3u, third = (first + 2u) % 3u;
        second = sizes[second] >= sizes[third] ? second : third;
        vec3 a = columns[first], b = columns[second];
        float size = max(sizes[first], 1.0e-30), share = dot(a, b) / size;
        vec3 other = b - share * a;
        float apart = dot(other, other);
        vec3 step = vec3(0.0);
        if (sizes[first] > noise) {
            step[second] =
                apart > noise ? dot(other, rest) / apart : share * dot(a, rest) / (size * (1.0 + share * share));
            step[first] =
                apart > noise ? dot(a, rest - step[second] * b) / size : dot(a, rest) / (size * (1.0 + share * share));
        }
        vec3 at = from + step;
        vec3 off = root * (best - at);
        float score = dot(off, off) + QEF_NEAR * most * dot(at - mass, at - mass);
        bool there = all(greaterThanEqual(at, lo - 1.0e-6)) && all(lessThanEqual(at, hi + 1.0e-6));
        if (there && score < least) {
            least = score;
            found = clamp(at, lo, hi);
        }
    }
    return found;
}

/* The point of the box lo..hi that fits the planes best. */
Qef qef_solve(vec3 lo, vec3 hi)
{
    Qef result;
    result.rank = 0u;
    result.free = vec3(0.0);
    vec3 mass = qef_mass_point(lo, hi);
    mat3 directions = qef_directions();
    /* Measuring the planes along the directions, instead of taking the eigenvalues, keeps the digits of small singular
     * values: their squares drown in the rounding of the great ones. The second round takes off what the first left. */
    vec3 squares = vec3(0.0), along = vec3(0.0);
    for (uint again = 0u; again < 2u; again++) {
        vec3 sum = vec3(0.0), from = mass + directions * along;
        squares = vec3(0.0);
        for (uint i = 0u; i < qef_count; i++) {
            vec4 plane = (qef_taken >> i & 1u) != 0u ? qef_planes[i] : vec4(0.0);
            vec3 n = plane.xyz * directions;
            precise float off = plane.w - dot(plane.xyz, from);
            squares += n * n;
            sum += n * off;
        }
        float most = max(max(squares.x, squares.y), squares.z);
        bvec3 counts = greaterThan(squares, vec3(QEF_CUT * QEF_CUT * most));
        along += mix(vec3(0.0), sum / max(squares, vec3(1.0e-30)), counts);
        squares = mix(vec3(0.0), squares, counts);
    }
    for (uint i = 0u; i < 3u; i++) {
        result.rank += squares[i] > 0.0 ? 1u : 0u;
        result.free = squares[i] > 0.0 ? result.free : directions[i];
    }
    result.best = mass + directions * along;
    result.at = result.best;
    if (any(lessThan(result.at, lo)) || any(greaterThan(result.at, hi))) {
        mat3 root = transpose(directions);
        for (uint i = 0u; i < 3u; i++)
            root[i] *= sqrt(squares);
        result.at = qef_on_box(root, result.at, mass, lo, hi);
    }
    if (!(all(greaterThanEqual(result.at, lo)) && all(lessThanEqual(result.at, hi))))
        result.at = mass;
    return result;
}

#endif
