/* joint.h against the rows of truth/table.csv, and its stiffness against differences of its force. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <math.h>
#include "joint.h"

static int column(const char *header, const char *name)
{
    int place = 0;
    const char *at = header;
    while (strncmp(at, name, strlen(name)) != 0) {
        at = strchr(at, ',');
        if (!at) exit(2);
        at++;
        place++;
    }
    return place;
}

static double cell(const char *line, int place)
{
    while (place-- > 0) line = strchr(line, ',') + 1;
    return atof(line);
}

int main(int count, char **arguments)
{
    char line[4096];
    FILE *file = count > 1 ? fopen(arguments[1], "r") : NULL;
    int x_column, force_column, rows = 0;
    double worst = 0.0, of_slope = 0.0;
    if (!file || !fgets(line, sizeof line, file)) return 2;
    x_column = column(line, "indentation_mm");
    force_column = column(line, "force_n");
    while (fgets(line, sizeof line, file)) {
        double x = cell(line, x_column), force = cell(line, force_column), h = 1e-4 * x;
        double slope = (joint_force(x + h) - joint_force(x - h)) / (2.0 * h);
        worst = fmax(worst, fabs(joint_force(x) / force - 1.0));
        of_slope = fmax(of_slope, fabs(slope / joint_stiffness(x) - 1.0));
        rows++;
    }
    printf("force within %.3g %% at %d unseen indentations, slope within %.3g %% of differences\n", 100.0 * worst, rows,
           100.0 * of_slope);
    return !(rows == 500 && worst < 1e-3 && of_slope < 1e-5 && joint_force(0.0) == 0.0 && joint_stiffness(-1.0) == 0.0);
}
