// Arrays in structs in arrays.
// expect: 6 21 4 1
struct Row { float cells[3]; int used; };
struct Grid { Row rows[2]; };
float sum(Row row)
{
    float s = 0.0;
    for (int i = 0; i < row.used; i++)
        s += row.cells[i];
    return s;
}
void main()
{
    Grid g;
    for (int r = 0; r < 2; r++) {
        g.rows[r].used = 3 - r;
        for (int c = 0; c < g.rows[r].cells.length(); c++)
            g.rows[r].cells[c] = float(c + 1) * (r == 0 ? one : 10.0 * half_ + two);
    }
    result[0] = sum(g.rows[0]);
    result[1] = sum(g.rows[1]);
    Grid copy = g;
    copy.rows[1].cells[0] = 4.0;
    result[2] = copy.rows[1].cells[0] * one;
    result[3] = float(g != copy);
}
