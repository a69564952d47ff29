"""The source documents, printed beside computed."""
