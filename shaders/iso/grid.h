/* GLSL only: where samples are. The same integers give the same floats in every kernel. */

/* Sample i of an axis. */
float sample_coordinate(hewn_grid grid, uint axis, uint i)
{
    precise float at = grid.origin[axis] + grid.cell * float(max(i, grid.rim) - grid.rim);
    return i + grid.rim >= grid.cells[axis] ? grid.far[axis] : at;
}
