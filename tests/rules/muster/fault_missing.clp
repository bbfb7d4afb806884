; SPDX-License-Identifier: Apache-2.0
; fails: 3 extends "no-such.clp": no such file beside this one or in the library
(extends "no-such.clp")
