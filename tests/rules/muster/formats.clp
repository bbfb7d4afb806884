; SPDX-License-Identifier: Apache-2.0
; options: library=no
; (format) is bounded: each directive, its width, its precision, and the result.
(deffunction much (?times) (bind ?s "%s") (loop-for-count ?times do (bind ?s (str-cat ?s ?s))) ?s)

; line: (str-length (format nil "%300d|%-300s|%300c" 1 a b))
; expect: 902
; line: (str-length (format nil "%f" 1e300))
; expect: 308
; line: (str-length (format nil "%1024.1024f" -1e308))
; expect: 1335
; line: (format nil "%-1024d" 1)
; expect: "1                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                               "
; line: (format nil "%1025d" 1)
; expect: [MUSTER1] Function format expected a width and a precision of at most 1024
; expect: ""
; expect: refused
; line: (format nil "%5000d" 1)
; expect: [MUSTER1] Function format expected a width and a precision of at most 1024
; expect: ""
; expect: refused
; line: (format nil "%.900000000f" 1)
; expect: [MUSTER1] Function format expected a width and a precision of at most 1024
; expect: ""
; expect: refused
; line: (format nil "%99999999999999999999s" a)
; expect: [MUSTER1] Function format expected a width and a precision of at most 1024
; expect: ""
; expect: refused
; line: (str-length (format nil "%s" (much 18)))
; expect: 524288
; line: (format nil "%s%s%s" (much 18) (much 18) a)
; expect: [MUSTER1] Function format expected a result of at most 1048576 bytes
; expect: ""
; expect: refused
; line: (format nil "%d" 1e300)
; expect: "-9223372036854775808"
; line: (format nil "[%5z" 1)
; expect: [IOFUN3] Invalid format flag "%5z" specified in format function.
; expect: ""
; expect: refused
; line: (format nil "[%5-3d]" 1)
; expect: [IOFUN3] Invalid format flag "%5-" specified in format function.
; expect: ""
; expect: refused
; line: (format nil "[%d")
; expect: [ARGACCES4] Function format expected exactly 3 argument(s)
; expect: ""
; expect: refused
; line: (format nil "[%d" abc)
; expect: [ARGACCES5] Function format expected argument #3 to be of type integer or float
; expect: ""
; expect: refused
