for (int i = 0; i < weights.length(); i++)
    sum += weights[i] * one;
