/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_value.h
 * Values of CLIPS: arguments and results of the functions that rules call, and what rules match.
 */
#ifndef MUSTER_AGENT_CLIPS_VALUE_H
#define MUSTER_AGENT_CLIPS_VALUE_H

#include "mind/clips_mind.h"

/** Ends the call in a CLIPS error: "Function NAME expected WANTED". */
void clips_value_refuse(void *env, const char *function, const char *wanted);

/** The same of one argument, counted from 1: "... expected WANTED as argument #1, and got GOT". */
void clips_value_refuse_argument(void *env, const char *function, int index, const char *wanted,
                                 const DATA_OBJECT *got);

void clips_value_bool(void *env, DATA_OBJECT *out, bool value);
void clips_value_float(void *env, DATA_OBJECT *out, double value);
void clips_value_integer(void *env, DATA_OBJECT *out, long long value);
void clips_value_symbol(void *env, DATA_OBJECT *out, const char *value);
void clips_value_multifield(DATA_OBJECT *out, struct multifield *fields);
void clips_value_floats(void *env, DATA_OBJECT *out, size_t count, const double *values);
void clips_value_set_float(void *env, struct multifield *fields, size_t index, double value);
void clips_value_set_symbol(void *env, struct multifield *fields, size_t index, const char *value);

/** A symbol, or the empty string. */
void clips_value_set_word(void *env, struct multifield *fields, size_t index, const char *value);

/** Evaluates an argument; counted from 1. @return false: it ended in an error */
bool clips_value_any(void *env, int index, DATA_OBJECT *out);

/** Evaluates an argument that must be a number; else a CLIPS error. */
bool clips_value_number(void *env, const char *function, int index, double *out);

/** As clips_value_number, for the first count arguments. */
bool clips_value_numbers(void *env, const char *function, int count, double *out);

/** Evaluates an argument that must be a whole number. */
bool clips_value_whole(void *env, const char *function, int index, long long *out);

/** Evaluates an argument that must be a symbol or a string. */
bool clips_value_word(void *env, const char *function, int index, const char **out);

/** Adds what a pattern has matched: 12, a fact's index; [ball], an instance; *, nothing is there.
 */
void clips_value_add_match(struct mu_text *out, const struct alphaMatch *match);

/** @return the number that a field is; 0 when it is none */
double clips_value_of(unsigned short type, const void *value);

/** Degrees of a radian. */
#define VALUE_DEG (180 / 3.14159265358979323846)

/** @return the same angle in (-180, 180] */
double value_norm_deg(double angle_deg);

#endif
