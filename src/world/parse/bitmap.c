/* SPDX-License-Identifier: Apache-2.0 */
#include "world/parse/parser.h"

#include <png.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const char bitmap_too_large[] = "the picture is too large";
static const char bitmap_cut_off[] = "the picture is cut off";

/* Makes room for the pixels. */
static const char *bitmap_take(struct bitmap *bitmap, long width, long height,
                               struct world_file *memory)
{
    if (width < 1 || height < 1) {
        return "the picture has no pixels";
    }
    if (width > BITMAP_SIDE_MAX || height > BITMAP_SIDE_MAX) {
        return bitmap_too_large;
    }
    bitmap->width = (int)width;
    bitmap->height = (int)height;
    bitmap->solid = worldfile_take(memory, (size_t)width * (size_t)height);
    return bitmap->solid ? NULL : bitmap_too_large;
}

static bool bitmap_solid(const struct bitmap_rule *rule, double grey)
{
    return (rule->negate ? 255 - grey : grey) < rule->threshold;
}

static const char *bitmap_read_png(struct bitmap *bitmap, FILE *in, const struct bitmap_rule *rule,
                                   struct world_file *memory)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_stdio(&image, in)) {
        return "not a PNG picture that libpng can read";
    }
    image.format = PNG_FORMAT_GRAY;
    const char *problem = image.width > BITMAP_SIDE_MAX || image.height > BITMAP_SIDE_MAX
                              ? bitmap_too_large
                              : bitmap_take(bitmap, image.width, image.height, memory);
    const png_color white = {255, 255, 255}; /* shines through where the picture is transparent */
    if (!problem && !png_image_finish_read(&image, &white, bitmap->solid, 0, NULL)) {
        problem = "the PNG picture is damaged";
    }
    png_image_free(&image);
    size_t pixels = problem ? 0 : (size_t)bitmap->width * (size_t)bitmap->height;
    for (size_t i = 0; i < pixels; i++) {
        bitmap->solid[i] = bitmap_solid(rule, bitmap->solid[i]);
    }
    return problem;
}

static int bitmap_skip_comment(FILE *in)
{
    int c;
    do {
        c = getc(in);
    } while (c != '\n' && c != EOF);
    return c;
}

/* Reads a whole number of a PNM header, over blanks and comments.  @return -1 when none is there */
static long bitmap_read_count(FILE *in)
{
    int c = getc(in);
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '#') {
        c = c == '#' ? bitmap_skip_comment(in) : getc(in);
    }
    long number = -1;
    while (c >= '0' && c <= '9' && number < 1000000) {
        number = (number < 0 ? 0 : number) * 10 + (c - '0');
        c = getc(in);
    }
    /* exactly one blank stands between the header and binary pixels: it is taken here */
    return number;
}

/* P1 may write its digits without blanks between them. */
static int bitmap_read_bit(FILE *in)
{
    int c = getc(in);
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
        c = getc(in);
    }
    return c == '0' || c == '1' ? c - '0' : EOF;
}

static const char *bitmap_read_bits(struct bitmap *bitmap, FILE *in, const struct bitmap_rule *rule)
{
    for (int y = 0; y < bitmap->height; y++) {
        int byte = 0;
        for (int x = 0; x < bitmap->width; x++) {
            if (x % 8 == 0 && (byte = getc(in)) == EOF) {
                return bitmap_cut_off;
            }
            bool black = (byte >> (7 - x % 8)) & 1;
            bitmap->solid[(size_t)y * (size_t)bitmap->width + (size_t)x] =
                bitmap_solid(rule, black ? 0 : 255);
        }
    }
    return NULL;
}

static const char *bitmap_read_greys(struct bitmap *bitmap, FILE *in, bool text, long white,
                                     const struct bitmap_rule *rule)
{
    size_t pixels = (size_t)bitmap->width * (size_t)bitmap->height;
    for (size_t i = 0; i < pixels; i++) {
        long grey;
        if (text) {
            grey = bitmap_read_count(in);
        } else {
            grey = getc(in);
            if (white > 255 && grey != EOF) {
                int low = getc(in);
                grey = low == EOF ? EOF : grey * 256 + low;
            }
        }
        if (grey < 0) {
            return bitmap_cut_off;
        }
        bitmap->solid[i] = bitmap_solid(rule, (double)grey * 255 / (double)white);
    }
    return NULL;
}

static const char *bitmap_read_pnm(struct bitmap *bitmap, FILE *in, int format,
                                   const struct bitmap_rule *rule, struct world_file *memory)
{
    long width = bitmap_read_count(in);
    long height = bitmap_read_count(in);
    bool grey = format == '2' || format == '5';
    long white = grey ? bitmap_read_count(in) : 1;
    if (white < 1 || white > 65535) {
        return "the largest grey value is not 1 to 65535";
    }
    const char *problem = bitmap_take(bitmap, width, height, memory);
    if (problem || grey) {
        return problem ? problem : bitmap_read_greys(bitmap, in, format == '2', white, rule);
    }
    if (format == '4') {
        return bitmap_read_bits(bitmap, in, rule);
    }
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++) {
        int bit = bitmap_read_bit(in);
        if (bit == EOF) {
            return bitmap_cut_off;
        }
        bitmap->solid[i] = bitmap_solid(rule, bit == 1 ? 0 : 255);
    }
    return NULL;
}

const char *bitmap_read(struct bitmap *bitmap, const char *path, const struct bitmap_rule *rule,
                        struct world_file *memory)
{
    *bitmap = (struct bitmap){0};
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) {
        return "no such file";
    }
    FILE *in = fopen(path, "rb");
    if (!in) {
        return "the file cannot be opened";
    }
    int first = getc(in);
    int second = getc(in);
    const char *problem = "neither a PNG picture nor a PNM one (P1, P2, P4, P5)";
    if (first == 'P' && (second == '1' || second == '2' || second == '4' || second == '5')) {
        problem = bitmap_read_pnm(bitmap, in, second, rule, memory);
    } else if (first == 0x89 && second == 'P') {
        rewind(in);
        problem = bitmap_read_png(bitmap, in, rule, memory);
    }
    fclose(in);
    return problem;
}

static bool bitmap_is_solid(const struct bitmap *bitmap, struct bitmap_rectangle r)
{
    for (int y = r.y; y < r.y + r.height; y++) {
        const uint8_t *row = bitmap->solid + (size_t)y * (size_t)bitmap->width + (size_t)r.x;
        for (int x = 0; x < r.width; x++) {
            if (!row[x]) {
                return false;
            }
        }
    }
    return true;
}

static struct bitmap_rectangle bitmap_grow_right(const struct bitmap *bitmap,
                                                 struct bitmap_rectangle r)
{
    while (r.x + r.width < bitmap->width &&
           bitmap_is_solid(bitmap, (struct bitmap_rectangle){r.x + r.width, r.y, 1, r.height})) {
        r.width++;
    }
    return r;
}

static struct bitmap_rectangle bitmap_grow_down(const struct bitmap *bitmap,
                                                struct bitmap_rectangle r)
{
    while (r.y + r.height < bitmap->height &&
           bitmap_is_solid(bitmap, (struct bitmap_rectangle){r.x, r.y + r.height, r.width, 1})) {
        r.height++;
    }
    return r;
}

bool bitmap_take_rectangle(struct bitmap *bitmap, size_t *at, struct bitmap_rectangle *out)
{
    size_t pixels = (size_t)bitmap->width * (size_t)bitmap->height;
    const uint8_t *found = memchr(bitmap->solid + *at, 1, pixels - *at);
    if (!found) {
        return false;
    }
    *at = (size_t)(found - bitmap->solid);
    struct bitmap_rectangle one = {(int)(*at % (size_t)bitmap->width),
                                   (int)(*at / (size_t)bitmap->width), 1, 1};
    struct bitmap_rectangle wide = bitmap_grow_down(bitmap, bitmap_grow_right(bitmap, one));
    struct bitmap_rectangle tall = bitmap_grow_right(bitmap, bitmap_grow_down(bitmap, one));
    *out = tall.width * tall.height > wide.width * wide.height ? tall : wide;
    for (int y = 0; y < out->height; y++) {
        memset(bitmap->solid + (size_t)(out->y + y) * (size_t)bitmap->width + (size_t)out->x, 0,
               (size_t)out->width);
    }
    return true;
}
