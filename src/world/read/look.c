/* SPDX-License-Identifier: Apache-2.0 */
/* How things look: their colours, and Stage's "returns". */
#include "world/read/look_colors.h"

#include "core/spell.h"
#include "world/read/builder.h"

#include <math.h>
#include <string.h>

enum { LOOK_COLORS = sizeof look_colors / sizeof look_colors[0], LOOK_NAME_MAX = 31 };

/* Names are told apart by their letters alone: "Navy Blue" is "navyblue", grey is gray. */
static bool look_plain(const char *text, char plain[LOOK_NAME_MAX + 1])
{
    size_t len = 0;
    for (; *text; text++) {
        if (*text == ' ') {
            continue;
        }
        if (len == LOOK_NAME_MAX) {
            return false;
        }
        plain[len++] = *text >= 'A' && *text <= 'Z' ? (char)(*text - 'A' + 'a') : *text;
    }
    plain[len] = '\0';
    char *grey = strstr(plain, "grey");
    if (grey) {
        grey[2] = 'a';
    }
    return len > 0;
}

static bool look_hexadecimal(const char *digits, size_t count, uint32_t *value)
{
    *value = 0;
    for (size_t i = 0; i < count; i++) {
        char c = digits[i];
        uint32_t digit = c >= '0' && c <= '9'   ? (uint32_t)(c - '0')
                         : c >= 'a' && c <= 'f' ? (uint32_t)(c - 'a' + 10)
                                                : 16;
        if (digit == 16) {
            return false;
        }
        *value = *value * 16 + digit;
    }
    return digits[count] == '\0';
}

/* gray0 is black, gray100 white. */
static bool look_gray(const char *plain, uint32_t *rgb)
{
    if (strncmp(plain, "gray", 4) != 0 || plain[4] == '\0' || strlen(plain) > 7) {
        return false;
    }
    uint32_t percent = 0;
    for (const char *c = plain + 4; *c; c++) {
        if (*c < '0' || *c > '9') {
            return false;
        }
        percent = percent * 10 + (uint32_t)(*c - '0');
    }
    uint32_t level = (percent * 255 + 50) / 100;
    *rgb = level * 0x10101;
    return percent <= 100;
}

bool look_color(const char *text, uint32_t *rgb)
{
    char plain[LOOK_NAME_MAX + 1];
    if (!look_plain(text, plain)) {
        return false;
    }
    if (plain[0] == '#' && strlen(plain) == 4) { /* each digit stands for two */
        bool read = look_hexadecimal(plain + 1, 3, rgb);
        *rgb = ((*rgb & 0xf00) << 8 | (*rgb & 0xf0) << 4 | (*rgb & 0xf)) * 0x11;
        return read;
    }
    if (plain[0] == '#') {
        return look_hexadecimal(plain + 1, 6, rgb);
    }
    for (size_t i = 0; i < LOOK_COLORS; i++) {
        if (strcmp(look_colors[i].name, plain) == 0) {
            *rgb = look_colors[i].rgb;
            return true;
        }
    }
    return look_gray(plain, rgb);
}

const char *look_color_near(const char *text)
{
    char plain[LOOK_NAME_MAX + 1];
    if (!look_plain(text, plain)) {
        return NULL;
    }
    struct mu_spell spell;
    mu_spell_init(&spell, plain);
    for (size_t i = 0; i < LOOK_COLORS; i++) {
        mu_spell_offer(&spell, look_colors[i].name);
    }
    return spell.nearest;
}

static mu_result look_read_name(struct builder *b, const struct worldfile_entity *entity,
                                uint32_t *rgb)
{
    const char *name = NULL;
    MU_TRY(builder_text(b, entity, "color", &name));
    if (!name || look_color(name, rgb)) {
        return MU_OK;
    }
    const char *meant = look_color_near(name);
    struct mu_fault_place at = builder_place(entity, "color");
    if (b->listener && meant) {
        return builder_fault(b, &at, "expected a colour, found '%.40s': did you mean '%s'?", name,
                             meant);
    }
    builder_warn(b, &at, name, "is not a colour that X11 has: it looks red");
    return MU_OK;
}

static mu_result look_read_rgba(struct builder *b, const struct worldfile_entity *entity,
                                uint32_t *rgb)
{
    double v[4] = {0};
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"color_rgba", v, 3, 4, NULL}));
    *rgb = 0;
    for (size_t i = 0; i < 3; i++) {
        if (!(v[i] >= 0 && v[i] <= 1)) {
            struct mu_fault_place at = builder_place(entity, "color_rgba");
            return builder_fault(b, &at, "expected shares of 0 to 1 for 'color_rgba', found %g",
                                 v[i]);
        }
        *rgb = *rgb * 256 + (uint32_t)lround(v[i] * 255);
    }
    return MU_OK;
}

/* @return how many definitions lie between a model and the property that it has from them */
static int look_depth(const struct worldfile_entity *entity, const char *key)
{
    const struct worldfile_property *wanted = worldfile_property(entity, key);
    int depth = 0;
    for (const struct worldfile_entity *e = entity; e; e = e->base, depth++) {
        for (const struct worldfile_property *p = e->properties; p; p = p->next) {
            if (p == wanted) {
                return depth;
            }
        }
    }
    return depth + 1;
}

static mu_result look_read_returns(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_look *look)
{
    double ranger = 1;
    double fiducial = 0;
    const double most = INT32_MAX;
    MU_TRY(builder_flag(b, entity, "obstacle_return", &look->stops));
    MU_TRY(builder_flag(b, entity, "gripper_return", &look->graspable));
    MU_TRY(
        builder_numbers(b, entity, (struct builder_numbers){"ranger_return", &ranger, 1, 1, NULL}));
    look->echoes = ranger >= 0;
    look->reflectance = ranger;
    MU_TRY(builder_number(b, entity,
                          (struct builder_numbers){"laser_return", &look->reflectance, 1, 1, NULL},
                          -most, most));
    /* A thing that neither stops nor echoes lies flat: it must not hide others. */
    look->shows = look->stops || look->echoes;
    MU_TRY(builder_flag(b, entity, "blob_return", &look->shows));
    MU_TRY(builder_number(b, entity,
                          (struct builder_numbers){"fiducial_return", &fiducial, 1, 1, NULL}, -most,
                          most));
    MU_TRY(builder_number(
        b, entity, (struct builder_numbers){"give_watts", &look->give_w, 1, 1, NULL}, 0, 1e9));
    if (fiducial != floor(fiducial)) {
        struct mu_fault_place at = builder_place(entity, "fiducial_return");
        return builder_fault(b, &at, "expected a whole number for 'fiducial_return', found %g",
                             fiducial);
    }
    look->fiducial = (int32_t)fiducial;
    return MU_OK;
}

mu_result look_read(struct builder *b, const struct worldfile_entity *entity,
                    struct world_look *look)
{
    *look = (struct world_look){.rgb = 0xff0000, /* as Stage's models without a colour */
                                .stops = true,
                                .echoes = true,
                                .shows = true};
    bool rgba = look_depth(entity, "color_rgba") < look_depth(entity, "color");
    mu_result color =
        rgba ? look_read_rgba(b, entity, &look->rgb) : look_read_name(b, entity, &look->rgb);
    MU_TRY(builder_go_on(b, color));
    return look_read_returns(b, entity, look);
}
