/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_number.h
 * A number as CLIPS prints it: as printf's %.15g does, and with ".0" where that has no point.
 */
#ifndef MUSTER_AGENT_CLIPS_NUMBER_H
#define MUSTER_AGENT_CLIPS_NUMBER_H

enum { CLIPS_NUMBER_BYTES = 32 };

/** @return bytes, which is what it was printed to */
const char *clips_number_print(double number, char bytes[CLIPS_NUMBER_BYTES]);

#endif
