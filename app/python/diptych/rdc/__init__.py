"""Any program: captures of RenderDoc are made (capture), replayed (replay), matched and compared (compare). Only replay needs RenderDoc
while it compares."""
