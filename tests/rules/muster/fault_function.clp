; SPDX-License-Identifier: Apache-2.0
; fails: 6 Missing function declaration for no-such-function
(defrule fine (a) => (stop))
(defrule bad
  (message mate-pos ?*mate* ?x)
  => (no-such-function ?x))
