"""One function for each command of `shipcosim`: what `import shipcosim` offers, and what the command line calls.

A call does the work and gives back a result, which knows what the run was and how to show and save itself. The command
line adds reading of arguments and printing, nothing else.
"""
