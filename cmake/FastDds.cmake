add_library(jink_idl INTERFACE)
