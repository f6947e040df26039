void main() { weight[0] = 1.0; }
