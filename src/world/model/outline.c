/* SPDX-License-Identifier: Apache-2.0 */
#include "world/model/world.h"

#include <math.h>

enum { BOX_CORNERS = OUTLINE_NUMBERS_MAX / 2 };

size_t outline_write(const struct world_shape *shape, const struct world_pose *pose,
                     float corners_m[OUTLINE_NUMBERS_MAX])
{
    static const double signs[BOX_CORNERS][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    if (shape->kind == WORLD_DISC) {
        corners_m[0] = (float)pose->x_m;
        corners_m[1] = (float)pose->y_m;
        return 2;
    }
    double c = cos(pose->heading_rad), s = sin(pose->heading_rad);
    for (size_t i = 0; i < BOX_CORNERS; i++) {
        double x_m = signs[i][0] * shape->half_x_m;
        double y_m = signs[i][1] * shape->half_y_m;
        corners_m[2 * i] = (float)(pose->x_m + c * x_m - s * y_m);
        corners_m[2 * i + 1] = (float)(pose->y_m + s * x_m + c * y_m);
    }
    return OUTLINE_NUMBERS_MAX;
}

bool outline_is_flat(const struct world_shape *shape)
{
    return !shape->look.stops && !shape->look.echoes;
}
