; SPDX-License-Identifier: Apache-2.0
; options: library=no
; fails: 5 expected (on-layer LAYER FUNCTION)
(deffunction trade (?id ?from ?performative ?content) TRUE)
(on-layer 0 trade)
