"""The command line: thin commands that read files, call the science or a slice's service, and say what came out."""
